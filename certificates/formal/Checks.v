(* The checks of all kinds of evidence, on a graph given as lists of in-neighbours. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Bytes Sets Tables Rules Soundness Refutation RefutationSound Evidence.
Import ListNotations.

Definition length_of {A} (l : list A) : nat := tally (fun _ => true) l 0.

Lemma length_of_is : forall A (l : list A), length_of l = length l.
Proof.
  assert (forall A (l : list A) k, tally (fun _ => true) l k = k + length l) as H.
  { induction l as [|v l IH]; intros k; simpl; [lia|]. rewrite IH. lia. }
  intros. unfold length_of. rewrite H. reflexivity.
Qed.

(* [heard i]: the nodes that i hears, each once. *)
Definition lists (n : nat) (h : nat -> nat -> bool) (heard : nat -> list nat) : Prop :=
  forall i, i < n -> NoDup (heard i) /\ forall u, In u (heard i) <-> h i u = true.

Section Graph.
Variable n : nat.
Variable h : nat -> nat -> bool.
Variable heard : nat -> list nat.
Hypothesis h_range : forall i v, h i v = true -> v < n.
Hypothesis h_loop : forall i, h i i = false.
Hypothesis heard_ok : lists n h heard.

Lemma heard_cnt : forall i f, i < n -> cnt (heard i) f = cnt (seq 0 n) (fun v => h i v && f v).
Proof.
  intros i f I. destruct (heard_ok i I) as [N H]. rewrite (cnt_incl (heard i) N (seq 0 n) f (seq_NoDup n 0)).
  - apply cnt_ext. intros v _. f_equal. apply eq_true_iff_eq. rewrite <- H, existsb_exists. split.
    + intros (u & U & E). apply Nat.eqb_eq in E. subst. assumption.
    + intros U. exists v. split; [assumption|apply Nat.eqb_refl].
  - intros v V. apply H in V. apply in_seq. apply h_range in V. lia.
Qed.

Lemma heard_length : forall i, i < n -> length (heard i) = cnt (seq 0 n) (h i).
Proof.
  intros i I. rewrite <- (cnt_true (heard i) (fun _ => true)) by reflexivity. rewrite heard_cnt by assumption.
  apply cnt_ext. intros. apply andb_true_r.
Qed.

(* violation *)
Definition reached (r : nat) (own : table unit) (l : list nat) : nat :=
  tally (fun i => r <=? tally (fun j => negb (has own j)) (heard i) 0) l 0.
Definition nonempty_list (l : list nat) : bool := match l with [] => false | _ => true end.
Definition violates (r s : nat) (l1 l2 : list nat) : bool :=
  let t1 := set_of l1 in
  let t2 := set_of l2 in
  let a1 := reached r t1 l1 in
  let a2 := reached r t2 l2 in
  ascending l1 && ascending l2 && forallb (fun i => i <? n) l1 && forallb (fun i => i <? n) l2
  && nonempty_list l1 && nonempty_list l2 && forallb (fun i => negb (has t1 i)) l2
  && (a1 <? length_of l1) && (a2 <? length_of l2) && (a1 + a2 <? s).

Lemma reached_is : forall r l, ascending l = true -> forallb (fun i => i <? n) l = true ->
  reached r (set_of l) l = cnt (seq 0 n) (reach (seq 0 n) h r (has (set_of l))).
Proof.
  intros r l A B. rewrite forallb_forall in B. unfold reached. rewrite tally_cnt. simpl.
  rewrite (cnt_incl l (ascending_nodup l A) (seq 0 n) _ (seq_NoDup n 0)).
  - apply cnt_ext. intros v V. apply in_seq in V. unfold reach. rewrite has_set_of. f_equal. f_equal.
    rewrite tally_cnt, heard_cnt by lia. reflexivity.
  - intros v V. specialize (B v V). apply Nat.ltb_lt in B. apply in_seq. lia.
Qed.

Lemma has_in : forall l i, has (set_of l) i = true <-> In i l.
Proof.
  intros. rewrite has_set_of, existsb_exists. split.
  - intros (u & U & E). apply Nat.eqb_eq in E. subst. assumption.
  - intros I. exists i. split; [assumption|apply Nat.eqb_refl].
Qed.

Lemma one_unreached : forall r l, ascending l = true -> forallb (fun i => i <? n) l = true ->
  reached r (set_of l) l < length_of l -> ~ same (Digraph n h) (reachable (Digraph n h) r (has (set_of l))) (has (set_of l)).
Proof.
  intros r l A B C E. rewrite (reached_is r l A B), length_of_is in C.
  assert (X : cnt (seq 0 n) (reach (seq 0 n) h r (has (set_of l))) = cnt (seq 0 n) (has (set_of l))).
  { apply cnt_ext. intros v V. apply in_seq in V. apply E. simpl. lia. }
  rewrite forallb_forall in B.
  assert (Y : length l = cnt (seq 0 n) (has (set_of l))); [|lia].
  rewrite <- (cnt_true l (fun _ => true)) by reflexivity. rewrite (cnt_incl l (ascending_nodup l A) (seq 0 n) _ (seq_NoDup n 0)).
  - apply cnt_ext. intros v _. rewrite has_set_of. apply andb_true_r.
  - intros v V. specialize (B v V). apply Nat.ltb_lt in B. apply in_seq. lia.
Qed.

Lemma violates_sound : forall r s l1 l2, violates r s l1 l2 = true -> ~ robust (Digraph n h) r s.
Proof.
  intros r s l1 l2 V [_ RO]. unfold violates in V. cbv zeta in V. repeat (apply andb_true_iff in V; destruct V as [V ?]).
  apply Nat.ltb_lt in H, H0, H1.
  assert (NE : forall l, nonempty_list l = true -> forallb (fun i => i <? n) l = true -> nonempty (Digraph n h) (has (set_of l))).
  { intros [|i l] N B; [discriminate|]. exists i. simpl in *. apply andb_true_iff in B. destruct B as [B _].
    apply Nat.ltb_lt in B. split; [assumption|]. apply has_in. left. reflexivity. }
  destruct (RO (has (set_of l1)) (has (set_of l2))) as [Q|[Q|Q]].
  - apply NE; assumption.
  - apply NE; assumption.
  - intros i _ Q1 Q2. apply has_in in Q2. rewrite forallb_forall in H2. specialize (H2 i Q2). rewrite Q1 in H2. discriminate.
  - revert Q. apply one_unreached; assumption.
  - revert Q. apply one_unreached; assumption.
  - rewrite !reached_is in H by assumption.
    change (s <= cnt (seq 0 n) (reach (seq 0 n) h r (has (set_of l1))) + cnt (seq 0 n) (reach (seq 0 n) h r (has (set_of l2)))) in Q. lia.
Qed.

(* degree *)
Definition degrees (r : nat) : bool := all_below n (fun i => n / 2 + r - 1 <=? length_of (heard i)).

Lemma degrees_sound : forall r s, 1 <= r -> degrees r = true -> no_pair (seq 0 n) h r s.
Proof.
  intros r s R D. apply lemma_3; [assumption|assumption|]. intros i I.
  pose proof (all_below_spec _ _ D i I) as B. apply Nat.leb_le in B. rewrite length_of_is, heard_length in B by assumption.
  assumption.
Qed.

(* refutation *)
Definition row_for (k : nat) (hearers : nat -> list nat) (r i : nat) : row :=
  Row i (w_bit (i mod Sets.size)) (single k i) (of_list k (heard i)) (of_list k (hearers i)) (length_of (heard i) + 1 - r).

Fixpoint cut (k : nat) (rows : list row) : list (list row) :=
  match k with 0 => [] | S k' => firstn Sets.size rows :: cut k' (skipn Sets.size rows) end.

Definition words : nat := n / Sets.size + 1.
Definition question_of (hearers : nat -> list nat) (r s : nat) : question :=
  let rows := map (row_for words hearers r) (seq 0 n) in
  let t := fold_left (fun t x => set (id x) x t) rows Leaf in
  Question (cut words rows) (fun i => get i t) (of_list words (seq 0 n)) n (s - 1) (16 * n + 64).

Lemma words_enough : n <= Sets.size * words.
Proof.
  unfold words. pose proof size_pos. pose proof (Nat.div_mod n Sets.size H). pose proof (Nat.mod_upper_bound n Sets.size H).
  rewrite Nat.mul_add_distr_l. lia.
Qed.

Lemma row_for_ok : forall hearers r i, i < n -> row_ok n h (fun i => cnt (seq 0 n) (h i) + 1 - r) (row_for words hearers r i).
Proof.
  intros hearers r i I. pose proof words_enough as W. split; simpl.
  - intros v. destruct (heard_ok i I) as [_ H]. destruct (le_lt_dec (Sets.size * words) v) as [L|L].
    + rewrite mem_beyond by (rewrite length_of_list; assumption). symmetry. apply not_true_is_false. intros Q.
      apply h_range in Q. lia.
    + rewrite mem_of_list by assumption. apply eq_true_iff_eq. rewrite <- H, existsb_exists. split.
      * intros (u & U & E). apply Nat.eqb_eq in E. subst. assumption.
      * intros U. exists v. split; [assumption|apply Nat.eqb_refl].
  - rewrite length_of_list. assumption.
  - intros v. split; [apply mem_single_only|]. intros ->. rewrite mem_single by lia. apply Nat.eqb_refl.
  - rewrite length_of_is, heard_length by assumption. reflexivity.
Qed.

Lemma cut_ok : forall P k rows, Forall P rows -> Forall (Forall P) (cut k rows).
Proof.
  intros P k. induction k as [|k IH]; intros rows F; simpl; constructor.
  - rewrite <- (firstn_skipn Sets.size rows) in F. apply Forall_app in F. tauto.
  - apply IH. rewrite <- (firstn_skipn Sets.size rows) in F. apply Forall_app in F. tauto.
Qed.

Lemma table_in : forall rows t (P : row -> Prop) v x, Forall P rows -> (forall y, get v t = Some y -> P y) ->
  get v (fold_left (fun t x => set (id x) x t) rows t) = Some x -> P x.
Proof.
  induction rows as [|y rows IH]; intros t P v x F T G; simpl in G; [auto|]. inversion F; subst.
  apply (IH (set (id y) y t) P v x H2); [|assumption]. intros z Z. rewrite get_set in Z.
  destruct (v =? id y); [injection Z as <-|]; auto.
Qed.

Lemma question_fine : forall hearers r s, let q := question_of hearers r s in
  let needs := fun i => cnt (seq 0 n) (h i) + 1 - r in
  Forall (Forall (row_ok n h needs)) (groups q) /\ Forall (Forall (fun x => id x < n)) (groups q) /\
  (forall v x, row_of q v = Some x -> row_ok n h needs x) /\ (forall v, mem (full q) v = (v <? n)).
Proof.
  intros hearers r s q needs.
  assert (F : Forall (row_ok n h needs) (map (row_for words hearers r) (seq 0 n))).
  { apply Forall_forall. intros x X. apply in_map_iff in X. destruct X as (i & <- & I). apply row_for_ok. apply in_seq in I. lia. }
  split; [apply cut_ok; assumption|]. split; [|split].
  - apply cut_ok. apply Forall_forall. intros x X. apply in_map_iff in X. destruct X as (i & <- & I). apply in_seq in I. simpl. lia.
  - intros v x G. simpl in G. apply (table_in _ _ _ v x F) in G; [assumption|]. intros y Y. unfold get in Y. rewrite find_leaf in Y. discriminate.
  - intros v. simpl. pose proof words_enough. destruct (le_lt_dec (Sets.size * words) v) as [L|L].
    + rewrite mem_beyond by (rewrite length_of_list; assumption). destruct (Nat.ltb_spec v n); [lia|reflexivity].
    + rewrite mem_of_list by assumption. apply eq_true_iff_eq. rewrite existsb_exists, Nat.ltb_lt. split.
      * intros (u & U & E). apply Nat.eqb_eq in E. apply in_seq in U. lia.
      * intros U. exists v. split; [apply in_seq; lia|apply Nat.eqb_refl].
Qed.

Lemma refutation_sound : forall hearers r s body, 1 <= r -> 1 <= s ->
  refutes (question_of hearers r s) body = Refuted -> no_pair (seq 0 n) h r s.
Proof.
  intros hearers r s body R S1 RE. apply lemma_1; [assumption|assumption|assumption|].
  destruct (question_fine hearers r s) as (Q1 & _ & Q3 & Q4).
  exact (refutes_sound n h _ (question_of hearers r s) h_range h_loop Q1 Q3 Q4 body RE).
Qed.
End Graph.
