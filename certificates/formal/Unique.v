(* Bytes are the canonical bytes of one graph only: the encoding can be read in one way. *)
From Coq Require Import List Bool Arith Lia ZArith ZifyNat.
From Formal Require Import Counting Bytes Robustness Canonical.
Import ListNotations.
Local Ltac Zify.zify_post_hook ::= Z.to_euclidean_division_equations.

(* The value of decimal digits; [decimal] is read back by it. *)
Definition digit (c : nat) : bool := (digit_0 <=? c) && (c <? digit_0 + 10).
Fixpoint value (l : list nat) (k : nat) : nat := match l with [] => k | c :: l' => value l' (k * 10 + (c - digit_0)) end.

Lemma value_app : forall l m k, value (l ++ m) k = value m (value l k).
Proof. induction l as [|c l IH]; intros; simpl; [reflexivity|apply IH]. Qed.

Lemma digits_app : forall fuel k tail, digits fuel k tail = digits fuel k [] ++ tail.
Proof.
  induction fuel as [|f IH]; intros k tail; [reflexivity|]. cbn [digits]. destruct (k <? 10); [reflexivity|].
  rewrite IH, (IH _ [digit_0 + k mod 10]), <- app_assoc. reflexivity.
Qed.

Lemma digits_value : forall fuel k, k < fuel -> value (digits fuel k []) 0 = k.
Proof.
  induction fuel as [|f IH]; intros k K; [lia|]. cbn [digits]. destruct (Nat.ltb_spec k 10).
  - cbn [value]. lia.
  - rewrite digits_app, value_app, IH by lia. cbn [value]. lia.
Qed.

Lemma digit_ok : forall k, k < 10 -> digit (digit_0 + k) = true.
Proof. intros. unfold digit. apply andb_true_iff. split; [apply Nat.leb_le|apply Nat.ltb_lt]; lia. Qed.

Lemma digits_digits : forall fuel k, forallb digit (digits fuel k []) = true.
Proof.
  induction fuel as [|f IH]; intros k; [reflexivity|]. cbn [digits]. destruct (Nat.ltb_spec k 10).
  - cbn [forallb]. rewrite digit_ok by assumption. reflexivity.
  - rewrite digits_app, forallb_app, IH. cbn [forallb]. rewrite digit_ok by lia. reflexivity.
Qed.

(* Where a run of digits ends is seen from the next character. *)
Lemma run_unique : forall a b x y c d, forallb digit a = true -> forallb digit b = true -> digit c = false -> digit d = false ->
  a ++ c :: x = b ++ d :: y -> a = b /\ c :: x = d :: y.
Proof.
  induction a as [|p a IH]; intros [|q b] x y c d A B C D E; simpl in *.
  - auto.
  - injection E as -> _. apply andb_true_iff in B. destruct B as [B _]. congruence.
  - injection E as <- _. apply andb_true_iff in A. destruct A as [A _]. congruence.
  - injection E as <- E. apply andb_true_iff in A, B. destruct A as [_ A], B as [_ B].
    destruct (IH b x y c d A B C D E) as [-> ->]. auto.
Qed.

Lemma decimal_unique : forall j k x y c d, digit c = false -> digit d = false ->
  decimal j ++ c :: x = decimal k ++ d :: y -> j = k /\ c :: x = d :: y.
Proof.
  intros j k x y c d C D E. apply run_unique in E; [|apply digits_digits|apply digits_digits|assumption|assumption].
  destruct E as [E F]. split; [|assumption]. apply (f_equal (fun l => value l 0)) in E. unfold decimal in E.
  rewrite !digits_value in E by lia. assumption.
Qed.

Lemma arc_unique : forall a b x y, show_arc a ++ x = show_arc b ++ y -> a = b /\ x = y.
Proof.
  intros [u v] [u' v'] x y E. unfold show_arc in E. cbn [fst snd app] in E. injection E as E.
  rewrite <- !app_assoc in E. cbn [app] in E. apply decimal_unique in E; [|reflexivity|reflexivity]. destruct E as [-> E].
  injection E as E. rewrite <- !app_assoc in E. cbn [app] in E. apply decimal_unique in E; [|reflexivity|reflexivity].
  destruct E as [-> E]. injection E as ->. auto.
Qed.

(* A string ends at the first quote that no backslash precedes. *)
Fixpoint body (l : list nat) : list nat * list nat :=
  match l with
  | [] => ([], [])
  | c :: l' =>
    if c =? quote then ([], l')
    else if c =? backslash then match l' with [] => ([], []) | d :: l'' => let (s, r) := body l'' in (c :: d :: s, r) end
    else let (s, r) := body l' in (c :: s, r)
  end.

Definition plain (c : nat) : Prop := c <> quote /\ c <> backslash.
Lemma body_plain : forall c l, plain c -> body (c :: l) = (c :: fst (body l), snd (body l)).
Proof.
  intros c l [Q B]. cbn [body]. destruct (Nat.eqb_spec c quote); [contradiction|]. destruct (Nat.eqb_spec c backslash); [contradiction|].
  destruct (body l). reflexivity.
Qed.
Lemma body_escape : forall d l, body (backslash :: d :: l) = (backslash :: d :: fst (body l), snd (body l)).
Proof. intros d l. cbn [body]. change (backslash =? quote) with false. rewrite Nat.eqb_refl. destruct (body l). reflexivity. Qed.

Lemma hex_plain : forall k, k < n16 -> plain (hex_digit k).
Proof.
  intros k K. change n16 with 16 in K. unfold hex_digit, plain. change digit_0 with 48. change letter_a with 97.
  change quote with 34. change backslash with 92. destruct (Nat.ltb_spec k 10); lia.
Qed.

Lemma body_u : forall k l, body (u_escape k ++ l) = (u_escape k ++ fst (body l), snd (body l)).
Proof.
  intros k l. unfold u_escape. cbn [app]. rewrite body_escape.
  rewrite !body_plain by (apply hex_plain; apply Nat.mod_upper_bound; discriminate). reflexivity.
Qed.

Lemma body_one : forall c l, body (escape c ++ l) = (escape c ++ fst (body l), snd (body l)).
Proof.
  intros c l. unfold escape.
  destruct (Nat.eqb_spec c quote); [apply body_escape|]. destruct (Nat.eqb_spec c backslash); [apply body_escape|]. cbn [orb].
  destruct (c =? 8); [apply body_escape|]. destruct (c =? 9); [apply body_escape|]. destruct (c =? 10); [apply body_escape|].
  destruct (c =? 12); [apply body_escape|]. destruct (c =? 13); [apply body_escape|].
  destruct (_ && _); [apply body_plain; split; assumption|]. destruct (c <? n65536); [apply body_u|].
  rewrite <- !app_assoc, !body_u. reflexivity.
Qed.

Lemma body_all : forall s x, body (flat_map escape s ++ quote :: x) = (flat_map escape s, x).
Proof.
  induction s as [|c s IH]; intros x; [cbn [flat_map app body]; rewrite Nat.eqb_refl; reflexivity|].
  cbn [flat_map]. rewrite <- app_assoc, body_one, IH. reflexivity.
Qed.

Lemma string_unique : forall s t x y, flat_map escape s ++ quote :: x = flat_map escape t ++ quote :: y ->
  flat_map escape s = flat_map escape t /\ x = y.
Proof. intros s t x y E. apply (f_equal body) in E. rewrite !body_all in E. injection E as E F. auto. Qed.

(* What may follow a label or an arc: a comma, or the end of a list. *)
Definition ends (c : nat) : Prop := c = comma \/ c = list_closes.
Lemma ends_digit : forall c, ends c -> digit c = false.
Proof. intros c [->| ->]; reflexivity. Qed.

(* A list of texts between commas is told by what follows it. *)
Lemma joined_unique : forall A (show : A -> list nat) (fine : A -> Prop),
  (forall a b c d x y, fine a -> fine b -> ends c -> ends d -> show a ++ c :: x = show b ++ d :: y -> show a = show b /\ c :: x = d :: y) ->
  (forall a, fine a -> exists o t, show a = o :: t /\ o <> list_closes) ->
  forall l m first x y, Forall fine l -> Forall fine m ->
  joined first (map show l) ++ list_closes :: x = joined first (map show m) ++ list_closes :: y ->
  map show l = map show m /\ x = y.
Proof.
  intros A show fine U OP l. induction l as [|a l IH]; intros [|b m] first x y FL FM E; cbn [map joined] in E.
  - injection E as ->. auto.
  - exfalso. inversion FM; subst. destruct (OP b) as (o & t & T & N); [assumption|]. rewrite T in E.
    destruct first; cbn [app] in E; injection E as E _; [congruence|discriminate].
  - exfalso. inversion FL; subst. destruct (OP a) as (o & t & T & N); [assumption|]. rewrite T in E.
    destruct first; cbn [app] in E; injection E as E _; [congruence|discriminate].
  - inversion FL; inversion FM; subst.
    assert (F : show a ++ joined false (map show l) ++ list_closes :: x = show b ++ joined false (map show m) ++ list_closes :: y).
    { rewrite <- !app_assoc in E. destruct first; cbn [app] in E; [exact E|]. injection E as E. exact E. }
    assert (ST : forall k (z : list nat), exists c t, joined false (map show k) ++ list_closes :: z = c :: t /\ ends c).
    { intros [|k0 k] z; cbn [map joined app]; [exists list_closes|exists comma]; eexists; (split; [reflexivity|unfold ends; auto]). }
    destruct (ST l x) as (c & t & C1 & C2). destruct (ST m y) as (d & u & D1 & D2). rewrite C1, D1 in F.
    apply U in F; try assumption. destruct F as [F G]. rewrite <- C1, <- D1 in G. apply IH in G; try assumption.
    destruct G as [G ->]. cbn [map]. rewrite F, G. auto.
Qed.

Definition in_bounds (d : nat) (l : label) : Prop := label_in_bounds d l = true.

Lemma int_digits : forall negative ds, int_in_bounds negative ds = true -> exists c t, ds = c :: t /\ forallb digit ds = true.
Proof.
  intros negative ds B. unfold int_in_bounds in B. destruct ds as [|c t]; [discriminate|]. apply andb_true_iff in B. destruct B as [_ B].
  exists c, t. split; [reflexivity|]. exact B.
Qed.

Lemma digit_is_no : forall c, digit c = true -> c <> minus /\ c <> quote /\ c <> list_opens /\ c <> list_closes.
Proof. intros c D. repeat split; intros ->; discriminate. Qed.

Lemma label_opens : forall d l, in_bounds d l -> exists o t, show_label l = o :: t /\ o <> list_closes.
Proof.
  intros d [negative ds|codes|parts] B; cbn [show_label].
  - unfold in_bounds in B. assert (I : int_in_bounds negative ds = true) by (destruct d; exact B).
    apply int_digits in I. destruct I as (c & t & -> & D). cbn [forallb] in D. apply andb_true_iff in D. destruct D as [D _].
    destruct negative; cbn [app]; eexists; eexists; (split; [reflexivity|]); [discriminate|apply digit_is_no in D; tauto].
  - eexists; eexists; (split; [reflexivity|discriminate]).
  - eexists; eexists; (split; [reflexivity|discriminate]).
Qed.

Lemma int_unique : forall na da nb db c e x y, int_in_bounds na da = true -> int_in_bounds nb db = true -> ends c -> ends e ->
  (if na then [minus] else []) ++ da ++ c :: x = (if nb then [minus] else []) ++ db ++ e :: y ->
  (if na then [minus] else []) ++ da = (if nb then [minus] else []) ++ db /\ c :: x = e :: y.
Proof.
  intros na da nb db c e x y A B C E Q. apply int_digits in A, B. destruct A as (a & s & TA & DA), B as (b & t & TB & DB).
  apply ends_digit in C, E. destruct na, nb; cbn [app] in *.
  - injection Q as Q. apply run_unique in Q; try assumption. destruct Q as [-> Q]. auto.
  - rewrite TB in Q, DB. cbn [app forallb] in Q, DB. injection Q as Q _. apply andb_true_iff in DB. destruct DB as [DB _].
    apply digit_is_no in DB. destruct DB as [DB _]. congruence.
  - rewrite TA in Q, DA. cbn [app forallb] in Q, DA. injection Q as Q _. apply andb_true_iff in DA. destruct DA as [DA _].
    apply digit_is_no in DA. destruct DA as [DA _]. congruence.
  - apply run_unique in Q; assumption.
Qed.

Definition kind (l : label) (o : nat) : Prop :=
  match l with LInt _ _ => o = minus \/ digit o = true | LStr _ => o = quote | LTup _ => o = list_opens end.
Lemma label_kind : forall d l, in_bounds d l -> exists o t, show_label l = o :: t /\ kind l o.
Proof.
  intros d [negative ds|codes|parts] B; cbn [show_label kind].
  - unfold in_bounds in B. assert (I : int_in_bounds negative ds = true) by (destruct d; exact B).
    apply int_digits in I. destruct I as (c & t & -> & D). cbn [forallb] in D. apply andb_true_iff in D. destruct D as [D _].
    destruct negative; cbn [app]; eexists; eexists; (split; [reflexivity|auto]).
  - eexists; eexists; split; reflexivity.
  - eexists; eexists; split; reflexivity.
Qed.

Lemma label_unique : forall d a b c e x y, in_bounds d a -> in_bounds d b -> ends c -> ends e ->
  show_label a ++ c :: x = show_label b ++ e :: y -> show_label a = show_label b /\ c :: x = e :: y.
Proof.
  induction d as [|d IH]; intros a b c e x y A B C E Q.
  all: destruct (label_kind _ a A) as (o & t & T & K); destruct (label_kind _ b B) as (p & u & U & L).
  all: assert (P : o = p) by (rewrite T, U in Q; cbn [app] in Q; injection Q as Q _; exact Q).
  all: subst p; destruct a as [na da|sa|pa], b as [nb db|sb|pb]; cbn [kind] in K, L;
    try (destruct K as [->|K]; try discriminate; subst o; discriminate);
    try (destruct L as [->|L]; try discriminate; subst o; discriminate);
    try (rewrite K in L; discriminate).
  all: clear T U K L; cbn [show_label] in *.
  1, 3: rewrite <- !app_assoc in Q; apply int_unique; assumption.
  1, 2: cbn [app] in Q; injection Q as Q; rewrite <- !app_assoc in Q; cbn [app] in Q; apply string_unique in Q;
    destruct Q as [-> Q]; auto.
  - cbn [app] in Q. injection Q as Q. rewrite <- !app_assoc in Q. cbn [app] in Q.
    apply (joined_unique label show_label (in_bounds d) IH (label_opens d)) in Q.
    + destruct Q as [-> Q]. auto.
    + apply Forall_forall. apply forallb_forall. exact A.
    + apply Forall_forall. apply forallb_forall. exact B.
Qed.

Definition fine_arc (a : nat * nat) : Prop := True.
Lemma arc_unique' : forall (a b : nat * nat) c d x y, fine_arc a -> fine_arc b -> ends c -> ends d ->
  show_arc a ++ c :: x = show_arc b ++ d :: y -> show_arc a = show_arc b /\ c :: x = d :: y.
Proof. intros a b c d x y _ _ _ _ E. apply arc_unique in E. destruct E as [-> E]. auto. Qed.
Lemma arc_opens : forall a, fine_arc a -> exists o t, show_arc a = o :: t /\ o <> list_closes.
Proof. intros a _. eexists; eexists; (split; [reflexivity|discriminate]). Qed.

Lemma map_arcs : forall l m, map show_arc l = map show_arc m -> l = m.
Proof.
  induction l as [|a l IH]; intros [|b m] E; try discriminate; [reflexivity|]. pose proof (f_equal (@tl _) E) as F.
  assert (G : show_arc a ++ [] = show_arc b ++ []) by (rewrite !app_nil_r; exact (f_equal (hd []) E)).
  apply arc_unique in G. destruct G as [-> _]. f_equal. apply IH. exact F.
Qed.

(* Bytes describe one graph only. *)
Theorem describes_one : forall b G G', describes b G -> describes b G' -> G = G'.
Proof.
  intros b G G' (arcs & labels & L & _ & E & ->) (arcs' & labels' & L' & _ & E' & ->). rewrite E in E'. clear E.
  unfold encode in E'. apply app_inv_head in E'.
  change middle with (list_closes :: skipn 1 middle) in E'. change closing with (list_closes :: skipn 1 closing) in E'.
  cbn [app] in E'.
  apply (joined_unique _ show_arc fine_arc arc_unique' arc_opens) in E'; [|apply Forall_forall; constructor|apply Forall_forall; constructor].
  destruct E' as [EA E']. apply map_arcs in EA. subst arcs'. apply app_inv_head in E'.
  unfold labels_ok in L, L'. apply andb_true_iff in L, L'. destruct L as [L _], L' as [L' _].
  apply (joined_unique _ show_label (in_bounds 8) (label_unique 8) (label_opens 8)) in E'.
  - destruct E' as [E' _]. apply (f_equal (@length (list nat))) in E'. rewrite !map_length in E'. rewrite E'. reflexivity.
  - apply Forall_forall. apply forallb_forall. exact L.
  - apply Forall_forall. apply forallb_forall. exact L'.
Qed.
