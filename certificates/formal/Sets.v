(* Sets of nodes as lists of words of 62 bits. Extraction makes a word an OCaml integer, see Extract.v: the eight
   operations on words are all that it replaces here. *)
From Coq Require Import NArith List Bool Arith Lia.
From Formal Require Import Counting.
Import ListNotations.

Definition word := N.
Definition w_zero : word := 0%N.
Definition w_and (a b : word) : word := N.land a b.
Definition w_or (a b : word) : word := N.lor a b.
Definition w_diff (a b : word) : word := N.ldiff a b.
Definition w_eqb (a b : word) : bool := N.eqb a b.
Definition w_bit (k : nat) : word := N.shiftl 1 (N.of_nat k).                    (* for k < 62 *)
Definition w_test (a : word) (k : nat) : bool := N.testbit a (N.of_nat k).       (* for k < 62 *)
Definition size := 62.                                                            (* bits of a word *)
Definition bits_of (a : word) : nat := cnt (seq 0 size) (w_test a).               (* how many are set *)
(* [w_pop] is [bits_of], sealed: Coq would otherwise try to compute with it, on unknown words. *)
Definition sealed : { f : word -> nat | forall a, f a = bits_of a }.
Proof. exists bits_of. reflexivity. Qed.
Definition w_pop : word -> nat := proj1_sig sealed.
Lemma w_pop_is : forall a, w_pop a = bits_of a.
Proof. exact (proj2_sig sealed). Qed.
Definition w_is0 (a : word) : bool := w_pop a =? 0.                              (* no bits *)
Lemma size_pos : size <> 0.
Proof. discriminate. Qed.
Global Opaque size.

Lemma w_zero_test : forall i, w_test w_zero i = false.
Proof. reflexivity. Qed.

Lemma w_bit_test : forall k i, w_test (w_bit k) i = (i =? k).
Proof.
  intros. unfold w_test, w_bit. rewrite N.shiftl_1_l, N.pow2_bits_eqb.
  destruct (Nat.eqb_spec i k); [subst; apply N.eqb_refl|apply N.eqb_neq; lia].
Qed.

Definition bits := list word.

Fixpoint mem (a : bits) (i : nat) : bool :=
  match a with [] => false | w :: a' => if i <? size then w_test w i else mem a' (i - size) end.

Fixpoint inter (a b : bits) : bits :=
  match a, b with v :: a', w :: b' => w_and v w :: inter a' b' | _, _ => [] end.
Fixpoint union (a b : bits) : bits :=
  match a, b with v :: a', w :: b' => w_or v w :: union a' b' | [], _ => b | _, [] => a end.
Fixpoint diff (a b : bits) : bits :=
  match a, b with v :: a', w :: b' => w_diff v w :: diff a' b' | [], _ => [] | _, [] => a end.
Fixpoint isempty (a : bits) : bool := match a with [] => true | w :: a' => w_is0 w && isempty a' end.
Fixpoint equal (a b : bits) : bool :=
  match a, b with v :: a', w :: b' => w_eqb v w && equal a' b' | [], [] => true | _, _ => false end.
(* Is [a] a subset of [b]? *)
Definition subset (a b : bits) : bool := isempty (diff a b).
(* [total] and the number of common nodes. *)
Fixpoint count (total : nat) (a b : bits) {struct a} : nat :=
  match a, b with v :: a', w :: b' => count (w_pop (w_and v w) + total) a' b' | _, _ => total end.

(* [k] words without and with bits, and with one of them. *)
Fixpoint none (k : nat) : bits := match k with 0 => [] | S k' => w_zero :: none k' end.
Fixpoint single (k i : nat) : bits :=
  match k with 0 => [] | S k' => if i <? size then w_bit i :: none k' else w_zero :: single k' (i - size) end.
Definition add (k : nat) (a : bits) (i : nat) : bits := union a (single k i).
Definition of_list (k : nat) (l : list nat) : bits := fold_left (add k) l (none k).

Lemma mem_inter : forall a b i, mem (inter a b) i = mem a i && mem b i.
Proof.
  induction a as [|v a IH]; destruct b as [|w b]; intros i; simpl; auto; [rewrite andb_false_r; reflexivity|].
  destruct (i <? size); [apply N.land_spec|apply IH].
Qed.

Lemma mem_union : forall a b i, mem (union a b) i = mem a i || mem b i.
Proof.
  induction a as [|v a IH]; destruct b as [|w b]; intros i; simpl; auto; [rewrite orb_false_r; reflexivity|].
  destruct (i <? size); [apply N.lor_spec|apply IH].
Qed.

Lemma mem_diff : forall a b i, mem (diff a b) i = mem a i && negb (mem b i).
Proof.
  induction a as [|v a IH]; destruct b as [|w b]; intros i; simpl; auto; [rewrite andb_true_r; reflexivity|].
  destruct (i <? size); [apply N.ldiff_spec|apply IH].
Qed.

Lemma w_is0_false : forall w i, w_is0 w = true -> i < size -> w_test w i = false.
Proof.
  intros w i W I. unfold w_is0 in W. rewrite w_pop_is in W. unfold bits_of in W. apply Nat.eqb_eq in W. destruct (w_test w i) eqn:T; [exfalso|reflexivity].
  assert (1 <= cnt (seq 0 size) (w_test w)); [|lia]. apply cnt_pos with i; [apply in_seq; lia|assumption].
Qed.

Lemma isempty_mem : forall a i, isempty a = true -> mem a i = false.
Proof.
  induction a as [|w a IH]; simpl; intros i H; [reflexivity|]. apply andb_true_iff in H. destruct H as [W H].
  destruct (Nat.ltb_spec i size); [apply w_is0_false|]; auto.
Qed.

Lemma isempty_true : forall a, (forall i, mem a i = false) -> isempty a = true.
Proof.
  induction a as [|w a IH]; intros H; [reflexivity|]. simpl. apply andb_true_iff. split.
  - unfold w_is0. rewrite w_pop_is. unfold bits_of. rewrite cnt_false; [reflexivity|]. intros i I. apply in_seq in I. specialize (H i). simpl in H.
    destruct (Nat.ltb_spec i size); [assumption|lia].
  - apply IH. intros i. specialize (H (size + i)). simpl in H. destruct (Nat.ltb_spec (size + i) size); [lia|].
    rewrite <- H. f_equal. lia.
Qed.

Lemma subset_mem : forall a b i, subset a b = true -> mem a i = true -> mem b i = true.
Proof.
  intros a b i H M. apply isempty_mem with (i := i) in H. rewrite mem_diff, M in H.
  destruct (mem b i); [reflexivity|discriminate].
Qed.

Lemma subset_true : forall a b, (forall i, mem a i = true -> mem b i = true) -> subset a b = true.
Proof.
  intros a b H. apply isempty_true. intros i. rewrite mem_diff. specialize (H i).
  destruct (mem a i); [rewrite H by reflexivity|]; reflexivity.
Qed.

Lemma equal_eq : forall a b, equal a b = true -> a = b.
Proof.
  induction a as [|v a IH]; destruct b as [|w b]; simpl; intros H; try discriminate; [reflexivity|].
  apply andb_true_iff in H. destruct H as [V H]. apply N.eqb_eq in V. f_equal; auto.
Qed.

Lemma mem_none : forall k i, mem (none k) i = false.
Proof. induction k as [|k IH]; intros i; simpl; [reflexivity|]. destruct (i <? size); [reflexivity|apply IH]. Qed.

Lemma mem_single : forall k i j, i < size * k -> mem (single k i) j = (j =? i).
Proof.
  induction k as [|k IH]; intros i j H; [lia|]. rewrite Nat.mul_succ_r in H. cbn [single]. destruct (Nat.ltb_spec i size); cbn [mem]; destruct (Nat.ltb_spec j size).
  - apply w_bit_test.
  - rewrite mem_none. symmetry. apply Nat.eqb_neq. lia.
  - rewrite w_zero_test. symmetry. apply Nat.eqb_neq. lia.
  - rewrite IH by lia. destruct (Nat.eqb_spec (j - size) (i - size)), (Nat.eqb_spec j i); auto; lia.
Qed.

Lemma mem_single_only : forall k i j, mem (single k i) j = true -> j = i.
Proof.
  induction k as [|k IH]; intros i j H; [discriminate|]. cbn [single] in H.
  destruct (Nat.ltb_spec i size); cbn [mem] in H; destruct (Nat.ltb_spec j size).
  - rewrite w_bit_test in H. apply Nat.eqb_eq; assumption.
  - rewrite mem_none in H. discriminate.
  - rewrite w_zero_test in H. discriminate.
  - apply IH in H. lia.
Qed.

Lemma mem_of_list : forall k l i, i < size * k -> mem (of_list k l) i = existsb (Nat.eqb i) l.
Proof.
  intros k l i I. assert (forall a, mem (fold_left (add k) l a) i = mem a i || existsb (Nat.eqb i) l) as H.
  { induction l as [|j l IH]; intros a; simpl; [rewrite orb_false_r; reflexivity|].
    rewrite IH. unfold add. rewrite mem_union, <- orb_assoc. f_equal. f_equal.
    destruct (Nat.eqb_spec i j) as [->|E]; [rewrite mem_single by assumption; apply Nat.eqb_refl|].
    apply not_true_is_false. intros M. apply mem_single_only in M. contradiction. }
  unfold of_list. rewrite H, mem_none. reflexivity.
Qed.

Lemma length_none : forall k, length (none k) = k.
Proof. induction k; simpl; auto. Qed.
Lemma length_single : forall k i, length (single k i) = k.
Proof. induction k as [|k IH]; intros i; simpl; [reflexivity|]. destruct (i <? size); simpl; rewrite ?length_none, ?IH; reflexivity. Qed.
Lemma length_union : forall a b, length a = length b -> length (union a b) = length a.
Proof. induction a as [|v a IH]; destruct b as [|w b]; simpl; intros; auto; discriminate. Qed.
Lemma length_of_list : forall k l, length (of_list k l) = k.
Proof.
  intros k l. assert (forall a, length a = k -> length (fold_left (add k) l a) = k) as H.
  { induction l as [|j l IH]; intros a A; simpl; [assumption|]. apply IH. unfold add.
    rewrite length_union; [assumption|]. rewrite length_single. assumption. }
  apply H. apply length_none.
Qed.

Lemma mem_beyond : forall a i, size * length a <= i -> mem a i = false.
Proof.
  induction a as [|w a IH]; intros i H; [reflexivity|]. cbn [length] in H. rewrite Nat.mul_succ_r in H. cbn [mem].
  destruct (Nat.ltb_spec i size); [lia|]. apply IH. lia.
Qed.

Lemma cnt_seq_shift : forall m k f, cnt (seq m k) f = cnt (seq 0 k) (fun i => f (m + i)).
Proof.
  intros. rewrite <- cnt_map with (g := fun i => m + i). f_equal. induction k as [|k IH] in m |- *; [reflexivity|].
  simpl. f_equal; [lia|]. rewrite IH, <- seq_shift, map_map. apply map_ext. intros; lia.
Qed.

Lemma cnt_seq_app : forall k m f, cnt (seq 0 (k + m)) f = cnt (seq 0 k) f + cnt (seq 0 m) (fun i => f (k + i)).
Proof. intros. rewrite seq_app, cnt_app, (cnt_seq_shift (0 + k)). reflexivity. Qed.

Lemma mem_low : forall w a i, i < size -> mem (w :: a) i = w_test w i.
Proof. intros. simpl. destruct (Nat.ltb_spec i size); [reflexivity|lia]. Qed.
Lemma mem_high : forall w a i, mem (w :: a) (size + i) = mem a i.
Proof. intros. simpl. destruct (Nat.ltb_spec (size + i) size); [lia|]. f_equal. lia. Qed.

Lemma pop_and : forall v w a b, w_pop (w_and v w) = cnt (seq 0 size) (fun i => mem (v :: a) i && mem (w :: b) i).
Proof.
  intros. rewrite w_pop_is. unfold bits_of. apply cnt_ext. intros i I. apply in_seq in I. rewrite !mem_low by lia. apply N.land_spec.
Qed.

Lemma count_step : forall t p c, p + t + c = t + (p + c).
Proof. intros. lia. Qed.
Lemma arith : forall u l, size * S l <= u -> exists m, u = size + m /\ size * l <= m.
Proof. intros u l U. exists (u - size). rewrite Nat.mul_succ_r in U. generalize dependent (size * l).
      generalize size. intros. lia. Qed.
Lemma tailp : forall v a w b m, cnt (seq 0 m) (fun i => mem (v :: a) (size + i) && mem (w :: b) (size + i)) = cnt (seq 0 m) (fun i => mem a i && mem b i).
Proof. intros. apply cnt_ext. intros i _. rewrite !mem_high. reflexivity. Qed.
Lemma stepp : forall v a w b m total, w_pop (w_and v w) + total + cnt (seq 0 m) (fun i => mem a i && mem b i) =
 total + cnt (seq 0 (size + m)) (fun i => mem (v :: a) i && mem (w :: b) i).
Proof. intros. rewrite cnt_seq_app, tailp, (pop_and v w a b). apply count_step. Qed.
Lemma count_nil : forall b total u, count total [] b = total + cnt (seq 0 u) (fun v => mem [] v && mem b v).
Proof. intros. rewrite cnt_false by reflexivity. apply plus_n_O. Qed.
Lemma count_nil_r : forall v a total u, count total (v :: a) [] = total + cnt (seq 0 u) (fun i => mem (v :: a) i && mem [] i).
Proof. intros. rewrite cnt_false by (intros; apply andb_false_r). apply plus_n_O. Qed.
Lemma count_spec : forall a b total u, size * length a <= u ->
  count total a b = total + cnt (seq 0 u) (fun v => mem a v && mem b v).
Proof.
  induction a as [|v a IH]; intros b total u U; [apply count_nil|].
  destruct b as [|w b]; [apply count_nil_r|].
  apply arith in U. destruct U as (m & E & M). rewrite E. cbn [count]. rewrite IH with (1 := M). apply stepp.
Qed.
