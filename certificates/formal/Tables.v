(* Tables indexed by numbers, as binary trees: place 0 is the root, 2 i + 1 is place i on the left, 2 i + 2 on the right. *)
From Coq Require Import List Bool Arith Lia ZArith ZifyNat.
From Formal Require Import Counting.
Import ListNotations.
Local Ltac Zify.zify_post_hook ::= Z.to_euclidean_division_equations.

Inductive table (A : Type) := Leaf | Node (l : table A) (v : option A) (r : table A).
Arguments Leaf {A}. Arguments Node {A}.

Fixpoint find {A} (fuel i : nat) (t : table A) : option A :=
  match fuel, t with
  | S f, Node l v r => if i =? 0 then v else if i mod 2 =? 1 then find f (i / 2) l else find f (i / 2 - 1) r
  | _, _ => None
  end.

Fixpoint store {A} (fuel i : nat) (x : A) (t : table A) : table A :=
  match fuel with
  | 0 => t
  | S f =>
    match t with
    | Leaf => if i =? 0 then Node Leaf (Some x) Leaf
              else if i mod 2 =? 1 then Node (store f (i / 2) x Leaf) None Leaf
              else Node Leaf None (store f (i / 2 - 1) x Leaf)
    | Node l v r => if i =? 0 then Node l (Some x) r
                    else if i mod 2 =? 1 then Node (store f (i / 2) x l) v r
                    else Node l v (store f (i / 2 - 1) x r)
    end
  end.

Definition get {A} (i : nat) (t : table A) : option A := find (S i) i t.
Definition set {A} (i : nat) (x : A) (t : table A) : table A := store (S i) i x t.

Lemma find_leaf : forall A f i, @find A f i Leaf = None.
Proof. destruct f; reflexivity. Qed.

Lemma find_store : forall A (x : A) f g i j t, i < f -> j < g ->
  find f i (store g j x t) = if i =? j then Some x else find f i t.
Proof.
  induction f as [|f IH]; intros g i j t I J; [lia|]. destruct g as [|g]; [lia|].
  destruct t as [|l v r]; cbn [store find].
  - destruct (Nat.eqb_spec j 0) as [->|J0].
    + cbn [find]. destruct (Nat.eqb_spec i 0) as [->|I0]; [reflexivity|]. rewrite !find_leaf.
      destruct (i mod 2 =? 1); reflexivity.
    + destruct (Nat.eqb_spec (j mod 2) 1) as [JO|JO]; cbn [find];
        (destruct (Nat.eqb_spec i 0) as [->|I0]; [destruct (Nat.eqb_spec 0 j); [lia|reflexivity]|]);
        (destruct (Nat.eqb_spec (i mod 2) 1) as [IO|IO]); rewrite ?find_leaf.
      * rewrite IH by lia. rewrite find_leaf. destruct (Nat.eqb_spec (i / 2) (j / 2)), (Nat.eqb_spec i j); auto; lia.
      * destruct (Nat.eqb_spec i j); [subst; lia|reflexivity].
      * destruct (Nat.eqb_spec i j); [subst; lia|reflexivity].
      * rewrite IH by lia. rewrite find_leaf. destruct (Nat.eqb_spec (i / 2 - 1) (j / 2 - 1)), (Nat.eqb_spec i j); auto; lia.
  - destruct (Nat.eqb_spec j 0) as [->|J0].
    + cbn [find]. destruct (Nat.eqb_spec i 0) as [->|I0]; reflexivity.
    + destruct (Nat.eqb_spec (j mod 2) 1) as [JO|JO]; cbn [find];
        (destruct (Nat.eqb_spec i 0) as [->|I0]; [destruct (Nat.eqb_spec 0 j); [lia|reflexivity]|]);
        (destruct (Nat.eqb_spec (i mod 2) 1) as [IO|IO]).
      * rewrite IH by lia. destruct (Nat.eqb_spec (i / 2) (j / 2)), (Nat.eqb_spec i j); auto; lia.
      * destruct (Nat.eqb_spec i j); [subst; lia|reflexivity].
      * destruct (Nat.eqb_spec i j); [subst; lia|reflexivity].
      * rewrite IH by lia. destruct (Nat.eqb_spec (i / 2 - 1) (j / 2 - 1)), (Nat.eqb_spec i j); auto; lia.
Qed.

Lemma get_set : forall A i j (x : A) t, get i (set j x t) = if i =? j then Some x else get i t.
Proof. intros. apply find_store; lia. Qed.

(* A set of numbers. *)
Definition has (t : table unit) (i : nat) : bool := match get i t with Some _ => true | None => false end.
Definition set_of (l : list nat) : table unit := fold_left (fun t i => set i tt t) l Leaf.

Lemma has_set : forall t i j, has (set j tt t) i = (i =? j) || has t i.
Proof. intros. unfold has. rewrite get_set. destruct (i =? j); reflexivity. Qed.

Lemma has_set_of : forall l i, has (set_of l) i = existsb (Nat.eqb i) l.
Proof.
  assert (forall l t i, has (fold_left (fun t i => set i tt t) l t) i = has t i || existsb (Nat.eqb i) l) as H.
  { induction l as [|j l IH]; intros t i; simpl; [rewrite orb_false_r; reflexivity|].
    rewrite IH, has_set. destruct (i =? j), (has t i); reflexivity. }
  intros. unfold set_of. rewrite H. unfold has, get. rewrite find_leaf. reflexivity.
Qed.

(* Lists at places: [gather l] has at v the u of all pairs (u, v) in l. *)
Definition at_place (t : table (list nat)) (v : nat) : list nat := match get v t with Some l => l | None => [] end.
Definition put (t : table (list nat)) (p : nat * nat) : table (list nat) :=
  let (u, v) := p in set v (u :: at_place t v) t.
Definition gather (l : list (nat * nat)) : table (list nat) := fold_left put l Leaf.

Lemma at_put : forall t u v w, at_place (put t (u, v)) w = if w =? v then u :: at_place t v else at_place t w.
Proof. intros. unfold put, at_place at 1. rewrite get_set. destruct (w =? v); reflexivity. Qed.

Lemma gather_spec : forall l, NoDup l -> forall v, NoDup (at_place (gather l) v) /\
  forall u, In u (at_place (gather l) v) <-> In (u, v) l.
Proof.
  assert (forall l t, NoDup l -> (forall v, NoDup (at_place t v)) ->
    (forall u v, In (u, v) l -> ~ In u (at_place t v)) -> forall v,
    NoDup (at_place (fold_left put l t) v) /\
    forall u, In u (at_place (fold_left put l t) v) <-> In u (at_place t v) \/ In (u, v) l) as H.
  { induction l as [|[a b] l IH]; intros t N NT D v; simpl; [split; [auto|tauto]|].
    inversion N as [|? ? NA NL]; subst. destruct (IH (put t (a, b))) with (v := v) as [I1 I2]; [assumption| | |].
    - intros w. rewrite at_put. destruct (w =? b); [|auto]. constructor; [|auto]. apply D. left. reflexivity.
    - intros u w Q. rewrite at_put. destruct (Nat.eqb_spec w b) as [->|]; [|apply D; right; assumption].
      intros [->|Q']; [contradiction|]. apply (D u b); [right|]; assumption.
    - split; [assumption|]. intros u. rewrite I2, at_put. destruct (Nat.eqb_spec v b) as [->|E]; simpl; split; intros Q.
      + destruct Q as [[->|Q]|Q]; auto.
      + destruct Q as [Q|[Q|Q]]; auto. injection Q as ->. auto.
      + destruct Q; auto.
      + destruct Q as [Q|[Q|Q]]; auto. injection Q as -> ->. contradiction. }
  intros l N v. destruct (H l Leaf N) with (v := v) as [A B].
  - intros. unfold at_place, get. rewrite find_leaf. constructor.
  - intros. unfold at_place, get. rewrite find_leaf. auto.
  - split; [exact A|]. intros u. unfold gather. rewrite B. unfold at_place, get at 1. rewrite find_leaf. simpl. tauto.
Qed.

(* [tally f l k]: k and the number of entries of l with f, in constant stack. *)
Fixpoint tally {A} (f : A -> bool) (l : list A) (k : nat) : nat :=
  match l with [] => k | v :: l' => tally f l' (if f v then S k else k) end.

Lemma tally_cnt : forall f l k, tally f l k = k + cnt l f.
Proof.
  induction l as [|v l IH]; intros k; simpl; [unfold cnt; simpl; lia|]. rewrite IH, cnt_cons. destruct (f v); simpl; lia.
Qed.

(* Strictly ascending lists. *)
Fixpoint ascending (l : list nat) : bool :=
  match l with a :: ((b :: _) as l') => (a <? b) && ascending l' | _ => true end.

Lemma ascending_above : forall l a, ascending (a :: l) = true -> forall b, In b l -> a < b.
Proof.
  induction l as [|c l IH]; intros a A b I; [contradiction|].
  change ((a <? c) && ascending (c :: l) = true) in A. apply andb_true_iff in A. destruct A as [A B].
  apply Nat.ltb_lt in A. destruct I as [->|I]; [assumption|]. specialize (IH c B b I). lia.
Qed.

Lemma ascending_tail : forall a l, ascending (a :: l) = true -> ascending l = true.
Proof. intros a [|b l] A; [reflexivity|].
  change ((a <? b) && ascending (b :: l) = true) in A. apply andb_true_iff in A. tauto. Qed.

Lemma ascending_nodup : forall l, ascending l = true -> NoDup l.
Proof.
  induction l as [|a l IH]; intros A; constructor.
  - intros I. apply (ascending_above l a A) in I. lia.
  - apply IH. apply ascending_tail in A. assumption.
Qed.

(* All numbers below a bound, from the last. *)
Fixpoint all_below (k : nat) (f : nat -> bool) : bool :=
  match k with 0 => true | S k' => if f k' then all_below k' f else false end.

Lemma all_below_spec : forall k f, all_below k f = true -> forall i, i < k -> f i = true.
Proof.
  induction k as [|k IH]; intros f A i I; [lia|]. simpl in A. destruct (f k) eqn:F; [|discriminate].
  destruct (Nat.eq_dec i k) as [->|]; [assumption|]. apply IH; [assumption|lia].
Qed.
