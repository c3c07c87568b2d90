(* The canonical bytes of a graph: what they are, and a reader that accepts no others.

   [encode] is the definition. The reader finds out the labels and arcs in any way it likes, and then follows the
   bytes along [encode] of what it has found; only this last step is trusted, and proven. *)
From Coq Require Import List Bool Arith Lia String Ascii.
From Formal Require Import Counting Bytes Robustness Tables.
Import ListNotations.
Local Open Scope list_scope.
Local Open Scope nat_scope.

(* Decimal numbers, without leading zeros. *)
Fixpoint digits (fuel k : nat) (tail : list nat) : list nat :=
  match fuel with
  | 0 => tail
  | S f => if k <? 10 then digit_0 + k :: tail else digits f (k / 10) (digit_0 + k mod 10 :: tail)
  end.
Definition decimal (k : nat) : list nat := digits (S k) k [].

(* A label: an integer (its sign and digits), a string of code points, or a tuple. *)
Inductive label := LInt (negative : bool) (digits : list nat) | LStr (codes : list nat) | LTup (parts : list label).

Definition hex_digit (k : nat) : nat := if k <? 10 then digit_0 + k else letter_a + (k - 10).
Definition u_escape (k : nat) : list nat :=
  [backslash; letter_u; hex_digit (k / n4096 mod n16); hex_digit (k / n256 mod n16); hex_digit (k / n16 mod n16); hex_digit (k mod n16)].
Definition escape (c : nat) : list nat :=
  if (c =? quote) || (c =? backslash) then [backslash; c] else if c =? 8 then [backslash; letter_b]
  else if c =? 9 then [backslash; letter_t] else if c =? 10 then [backslash; letter_n]
  else if c =? 12 then [backslash; letter_f] else if c =? 13 then [backslash; letter_r]
  else if (n32 <=? c) && (c <? n128 - 1) then [c]
  else if c <? n65536 then u_escape c
  else u_escape (high_surrogates + (c - n65536) / n1024) ++ u_escape (low_surrogates + (c - n65536) mod n1024).

(* Texts one after the other with commas between them. *)
Fixpoint joined (first : bool) (l : list (list nat)) : list nat :=
  match l with [] => [] | x :: l' => (if first then [] else [comma]) ++ x ++ joined false l' end.

Fixpoint show_label (l : label) : list nat :=
  match l with
  | LInt negative ds => (if negative then [minus] else []) ++ ds
  | LStr codes => [quote] ++ flat_map escape codes ++ [quote]
  | LTup parts => [list_opens] ++ joined true (map show_label parts) ++ [list_closes]
  end.
Definition show_arc (a : nat * nat) : list nat := [list_opens] ++ decimal (fst a) ++ [comma] ++ decimal (snd a) ++ [list_closes].

Definition opening : list nat := text "{""arcs"":[".
Definition middle : list nat := text "],""format"":""robustness/graph/1"",""labels"":[".
Definition closing : list nat := text "]}".
Definition encode (arcs : list (nat * nat)) (labels : list label) : list nat :=
  opening ++ joined true (map show_arc arcs) ++ middle ++ joined true (map show_label labels) ++ closing.

(* Labels in bounds, and in strictly ascending order: integers, strings, tuples, each kind in its own order. *)
Fixpoint compare_lists (a b : list nat) : comparison :=
  match a, b with
  | [], [] => Eq | [], _ => Lt | _, [] => Gt
  | x :: a', y :: b' => match x ?= y with Eq => compare_lists a' b' | c => c end
  end.
Definition compare_sizes (a b : list nat) : comparison :=
  match List.length a ?= List.length b with Eq => compare_lists a b | c => c end.
Definition compare_ints (m : bool) (a : list nat) (n : bool) (b : list nat) : comparison :=
  match m, n with true, false => Lt | false, true => Gt | false, false => compare_sizes a b | true, true => compare_sizes b a end.
Fixpoint compare_labels (a b : label) {struct a} : comparison :=
  match a, b with
  | LInt m x, LInt n y => compare_ints m x n y
  | LInt _ _, _ => Lt | _, LInt _ _ => Gt
  | LStr x, LStr y => compare_lists x y
  | LStr _, _ => Lt | _, LStr _ => Gt
  | LTup x, LTup y =>
    (fix go (x y : list label) {struct x} : comparison :=
       match x, y with
       | [], [] => Eq | [], _ => Lt | _, [] => Gt
       | u :: x', v :: y' => match compare_labels u v with Eq => go x' y' | c => c end
       end) x y
  end.

Definition int_in_bounds (negative : bool) (ds : list nat) : bool :=
  match ds with
  | [] => false
  | c :: rest =>
    if c =? digit_0 then match rest with [] => negb negative | _ => false end
    else match compare_sizes ds (text (if negative then "9223372036854775808" else "9223372036854775807")) with
         | Gt => false | _ => true end
  end && forallb (fun c => (digit_0 <=? c) && (c <=? digit_9)) ds.
Fixpoint label_in_bounds (depth : nat) (l : label) : bool :=
  match l with
  | LInt negative ds => int_in_bounds negative ds
  | LStr codes => forallb (fun c => (c <? high_surrogates) || ((after_surrogates <=? c) && (c <? end_of_unicode))) codes
  | LTup parts => match depth with 0 => false | S d => forallb (label_in_bounds d) parts end
  end.
Fixpoint labels_ascend (l : list label) : bool :=
  match l with
  | a :: ((b :: _) as l') => match compare_labels a b with Lt => labels_ascend l' | _ => false end
  | _ => true
  end.
Definition labels_ok (l : list label) : bool := forallb (label_in_bounds 8) l && labels_ascend l.

(* Arcs between different nodes below n, strictly ascending. *)
Fixpoint arcs_ok (n : nat) (arcs : list (nat * nat)) : bool :=
  match arcs with
  | [] => true
  | (u, v) :: rest =>
    if (u <? n) && (v <? n) && negb (u =? v)
       && match rest with [] => true | (u', v') :: _ => (u <? u') || ((u =? u') && (v <? v')) end
    then arcs_ok n rest else false
  end.

Definition graph_of (n : nat) (arcs : list (nat * nat)) : digraph :=
  Digraph n (fun i j => existsb (fun a => (fst a =? j) && (snd a =? i)) arcs).

(* The bytes are the canonical bytes of the graph G. *)
Definition describes (b : bytes) (G : digraph) : Prop :=
  exists arcs labels, labels_ok labels = true /\ arcs_ok (List.length labels) arcs = true /\
    contents b = encode arcs labels /\ G = graph_of (List.length labels) arcs.

(* Following the bytes along a text. *)
Fixpoint follow (b : bytes) (pos : nat) (l : list nat) : option nat :=
  match l with
  | [] => Some pos
  | c :: l' => if (pos <? len b) && (byte_at b pos =? c) then follow b (S pos) l' else None
  end.
Fixpoint follow_all {A} (show : A -> list nat) (b : bytes) (pos : nat) (first : bool) (l : list A) : option nat :=
  match l with
  | [] => Some pos
  | x :: l' => match follow b pos (if first then show x else comma :: show x) with
               | Some pos' => follow_all show b pos' false l'
               | None => None end
  end.
Definition spelled (b : bytes) (arcs : list (nat * nat)) (labels : list label) : bool :=
  match follow b 0 opening with None => false | Some p1 =>
  match follow_all show_arc b p1 true arcs with None => false | Some p2 =>
  match follow b p2 middle with None => false | Some p3 =>
  match follow_all show_label b p3 true labels with None => false | Some p4 =>
  match follow b p4 closing with None => false | Some p5 => p5 =? len b end end end end end.

Definition slice (b : bytes) (p q : nat) : list nat := map (byte_at b) (seq p (q - p)).

Lemma follow_spec : forall b l p q, follow b p l = Some q -> q = p + List.length l /\ slice b p q = l.
Proof.
  intros b l. induction l as [|c l IH]; intros p q F; cbn [follow] in F.
  - injection F as <-. split; [simpl; lia|]. unfold slice. rewrite Nat.sub_diag. reflexivity.
  - destruct ((p <? len b) && (byte_at b p =? c)) eqn:E; [|discriminate]. apply andb_true_iff in E. destruct E as [_ E].
    apply Nat.eqb_eq in E. apply IH in F. destruct F as [F S]. split; [simpl; lia|]. unfold slice in *.
    replace (q - p) with (Datatypes.S (q - Datatypes.S p)) by lia. simpl. rewrite E, S. reflexivity.
Qed.

Lemma slice_app : forall b p q r, p <= q -> q <= r -> slice b p q ++ slice b q r = slice b p r.
Proof.
  intros b p q r P Q. unfold slice. rewrite <- map_app. f_equal. replace (r - p) with ((q - p) + (r - q)) by lia.
  rewrite seq_app. replace (p + (q - p)) with q by lia. reflexivity.
Qed.

Lemma follow_all_spec : forall A (show : A -> list nat) b l p q first, follow_all show b p first l = Some q ->
  p <= q /\ slice b p q = joined first (map show l).
Proof.
  intros A show b l. induction l as [|x l IH]; intros p q first F; cbn [follow_all] in F.
  - injection F as <-. split; [lia|]. unfold slice. rewrite Nat.sub_diag. reflexivity.
  - destruct (follow b p (if first then show x else comma :: show x)) as [m|] eqn:E; [|discriminate].
    apply follow_spec in E. destruct E as [E1 E2]. apply IH in F. destruct F as [F1 F2]. split; [lia|].
    rewrite <- (slice_app b p m q), E2, F2 by lia. simpl. destruct first; reflexivity.
Qed.

Lemma spelled_sound : forall b arcs labels, spelled b arcs labels = true -> contents b = encode arcs labels.
Proof.
  intros b arcs labels S. unfold spelled in S.
  destruct (follow b 0 opening) as [p1|] eqn:E1; [|discriminate]. destruct (follow_all show_arc b p1 true arcs) as [p2|] eqn:E2; [|discriminate].
  destruct (follow b p2 middle) as [p3|] eqn:E3; [|discriminate]. destruct (follow_all show_label b p3 true labels) as [p4|] eqn:E4; [|discriminate].
  destruct (follow b p4 closing) as [p5|] eqn:E5; [|discriminate]. apply Nat.eqb_eq in S.
  apply follow_spec in E1, E3, E5. apply follow_all_spec in E2, E4.
  destruct E1 as [A1 B1], E2 as [A2 B2], E3 as [A3 B3], E4 as [A4 B4], E5 as [A5 B5].
  unfold encode. rewrite <- B1, <- B2, <- B3, <- B4, <- B5.
  rewrite (slice_app b p3 p4 p5), (slice_app b p2 p3 p5), (slice_app b p1 p2 p5), (slice_app b 0 p1 p5) by lia.
  unfold contents, slice. rewrite Nat.sub_0_r, S. reflexivity.
Qed.

(* What the arcs say about the in-neighbours. *)
Lemma arcs_ok_in : forall n arcs u v, arcs_ok n arcs = true -> In (u, v) arcs -> u < n /\ v < n /\ u <> v.
Proof.
  induction arcs as [|[a b] arcs IH]; intros u v A I; [contradiction|]. cbn [arcs_ok] in A.
  destruct (_ && _) eqn:E in A; [|discriminate]. apply andb_true_iff in E. destruct E as [E _].
  apply andb_true_iff in E. destruct E as [E N]. apply andb_true_iff in E. destruct E as [E1 E2].
  destruct I as [I|I]; [|auto]. injection I as <- <-. apply Nat.ltb_lt in E1, E2. apply negb_true_iff, Nat.eqb_neq in N. auto.
Qed.

Lemma arcs_ok_above : forall n arcs a b, arcs_ok n ((a, b) :: arcs) = true -> forall u v, In (u, v) arcs -> a < u \/ (a = u /\ b < v).
Proof.
  induction arcs as [|[c d] arcs IH]; intros a b A u v I; [contradiction|].
  change (arcs_ok n ((a, b) :: (c, d) :: arcs)) with
    (if (a <? n) && (b <? n) && negb (a =? b) && ((a <? c) || ((a =? c) && (b <? d))) then arcs_ok n ((c, d) :: arcs) else false) in A.
  destruct (_ && _) eqn:E in A; [|discriminate]. apply andb_true_iff in E. destruct E as [_ E].
  assert (L : a < c \/ (a = c /\ b < d)).
  { apply orb_true_iff in E. destruct E as [E|E]; [left; apply Nat.ltb_lt; assumption|right].
    apply andb_true_iff in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E1. apply Nat.ltb_lt in E2. auto. }
  destruct I as [I|I]; [injection I as <- <-; assumption|]. specialize (IH c d A u v I). lia.
Qed.

Lemma arcs_ok_nodup : forall n arcs, arcs_ok n arcs = true -> NoDup arcs.
Proof.
  induction arcs as [|[a b] arcs IH]; intros A; constructor.
  - intros I. apply (arcs_ok_above n arcs a b A) in I. lia.
  - apply IH. cbn [arcs_ok] in A. destruct (_ && _) in A; [assumption|discriminate].
Qed.

Lemma graph_hears : forall n arcs i j, hears (graph_of n arcs) i j = true <-> In (j, i) arcs.
Proof.
  intros. simpl. rewrite existsb_exists. split.
  - intros ([u v] & I & E). apply andb_true_iff in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E1, E2. simpl in *. subst. assumption.
  - intros I. exists (j, i). split; [assumption|]. simpl. rewrite !Nat.eqb_refl. reflexivity.
Qed.
