(* What each kind of evidence proves of sets that hold apart, on a graph given as lists of in-neighbours. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Bytes Sets Tables Rules Soundness Refutation Robustness Evidence Checks Roles RolesSound
  Separation SeparationSound Apart.
Import ListNotations.

(* In a (2f+1)-robust graph no sets hold apart, whatever the faces and the bound (docs/certificate-format.md, Tolerance). *)
Lemma robust_together : forall n h f two local, no_pair (seq 0 n) h (2 * f + 1) 1 -> together (Digraph n h) f two local.
Proof.
  intros n h f two local NP M S1 S2 [BM (i & I & Si & Mi) (j & J & Sj & Mj) D _ D1 D2]. set (V := seq 0 n) in *.
  set (N := fun (S : set) v => S v && negb (M v)). simpl in I, J.
  assert (FEW : forall k, k < n -> M k = false -> cnt V (fun v => h k v && M v) <= f).
  { intros k K Mk. unfold obeys in BM. destruct local; [apply BM; assumption|]. apply Nat.le_trans with (2 := BM).
    apply cnt_le. intros v _ Q. apply andb_true_iff in Q. tauto. }
  assert (OUT : forall S, (forall k, k < n -> S k = true -> M k = false -> size (Digraph n h) (fun v => h k v && negb (S v || (two && M v))) <= f) ->
    forall k, In k V -> N S k = true -> outside V h (N S) k <= 2 * f).
  { intros S DS k K Nk. apply in_seq in K. apply andb_true_iff in Nk. destruct Nk as [Sk Mk]. apply negb_true_iff in Mk.
    specialize (DS k ltac:(lia) Sk Mk). specialize (FEW k ltac:(lia) Mk). unfold size in DS. simpl in DS. fold V in DS.
    apply Nat.le_trans with (cnt V (fun v => h k v && negb (S v || (two && M v))) + cnt V (fun v => h k v && M v)); [|lia].
    unfold outside. rewrite !cnt_sum, <- sum_add. apply sum_le. intros v _. unfold N.
    destruct (h k v), (S v), (M v), two; simpl; lia. }
  specialize (OUT S1 D1) as O1. specialize (OUT S2 D2) as O2.
  assert (Z : forall S, (forall k, In k V -> N S k = true -> outside V h (N S) k <= 2 * f) -> cnt V (reach V h (2 * f + 1) (N S)) = 0).
  { intros S O. apply cnt_false. intros k K. unfold reach. destruct (N S k) eqn:E; [|reflexivity]. apply Nat.leb_gt.
    specialize (O k K E). lia. }
  assert (Ni : N S1 i = true) by (unfold N; rewrite Si, Mi; reflexivity).
  assert (Nj : N S2 j = true) by (unfold N; rewrite Sj, Mj; reflexivity).
  assert (Iv : In i V) by (apply in_seq; lia). assert (Jv : In j V) by (apply in_seq; lia).
  destruct (NP (N S1) (N S2)) as [Q|[Q|Q]]; eauto.
  - intros k K A B. apply in_seq in K. apply andb_true_iff in A, B. apply (D k); [simpl; lia|tauto|tauto].
  - specialize (Q i Iv Ni). specialize (O1 i Iv Ni). lia.
  - specialize (Q j Jv Nj). specialize (O2 j Jv Nj). lia.
  - rewrite !Z in Q by assumption. lia.
Qed.

Section Graph.
Variable n : nat.
Variable h : nat -> nat -> bool.
Variable heard : nat -> list nat.
Hypothesis h_range : forall i v, h i v = true -> v < n.
Hypothesis h_loop : forall i, h i i = false.
Hypothesis heard_ok : lists n h heard.

(* refutation *)
Definition threat_of (hearers : nat -> list nat) (f : nat) (two local : bool) : threat :=
  Threat (question_of n heard hearers (f + 1) (f + 1)) two local.

Lemma threat_sound : forall hearers f two local,
  sound_threat n h (fun i => cnt (seq 0 n) (h i) + 1 - (f + 1)) (threat_of hearers f two local).
Proof.
  intros hearers f two local. destruct (question_fine n h heard h_range h_loop heard_ok hearers (f + 1) (f + 1)) as (Q1 & Q2 & Q3 & Q4).
  split; auto.
Qed.

(* Sets that hold apart are a solution. *)
Lemma apart_solution : forall hearers f two local M S1 S2, apart (Digraph n h) f two local M S1 S2 ->
  solution n h (fun i => cnt (seq 0 n) (h i) + 1 - (f + 1)) (threat_of hearers f two local)
    (fun v => (v <? n) && S1 v && negb (M v)) (fun v => (v <? n) && S2 v && negb (M v))
    (fun v => (v <? n) && M v && (two || S1 v)) (fun v => (v <? n) && M v && (two || S2 v)).
Proof.
  intros hearers f two local M S1 S2 [BM (i & I & Si & Mi) (j & J & Sj & Mj) D FA D1 D2]. simpl in I, J.
  assert (HELD : forall (S : set) k, (forall k, k < n -> S k = true -> M k = false -> size (Digraph n h) (fun v => h k v && negb (S v || (two && M v))) <= f) ->
    (k <? n) && S k && negb (M k) = true ->
    cnt (seq 0 n) (h k) + 1 - (f + 1) <=
    cnt (seq 0 n) (fun v => h k v && ((v <? n) && S v && negb (M v) || (v <? n) && M v && (two || S v)))).
  { intros S k DS K. apply andb_true_iff in K. destruct K as [K Mk]. apply andb_true_iff in K. destruct K as [K Sk].
    apply Nat.ltb_lt in K. apply negb_true_iff in Mk. specialize (DS k K Sk Mk). unfold size in DS. simpl in DS.
    rewrite (cnt_split (seq 0 n) (h k) (fun v => S v || (two && M v))).
    assert (E : cnt (seq 0 n) (fun v => h k v && (S v || (two && M v))) =
                cnt (seq 0 n) (fun v => h k v && ((v <? n) && S v && negb (M v) || (v <? n) && M v && (two || S v)))).
    { apply cnt_ext. intros v V. apply in_seq in V. destruct (Nat.ltb_spec v n); [|lia].
      destruct (h k v), (S v), (M v), two; reflexivity. }
    lia. }
  assert (BIG : forall k, k < n -> (k <? n) && M k && (two || S1 k) || (k <? n) && M k && (two || S2 k) = M k).
  { intros k K. destruct (Nat.ltb_spec k n); [|lia]. destruct two; [destruct (M k); reflexivity|]. specialize (FA k K).
    destruct (M k); [|reflexivity]. simpl. apply FA. reflexivity. }
  split.
  - intros v V. destruct (Nat.ltb_spec v n); [assumption|discriminate].
  - intros v V. destruct (Nat.ltb_spec v n); [assumption|discriminate].
  - intros v V. destruct (Nat.ltb_spec v n); [assumption|discriminate].
  - intros v V. destruct (Nat.ltb_spec v n); [assumption|discriminate].
  - intros v A B. apply andb_true_iff in A, B. destruct A as [A _], B as [B _]. apply andb_true_iff in A, B.
    apply (D v); [apply Nat.ltb_lt; tauto|tauto|tauto].
  - intros v A. apply andb_true_iff in A. destruct A as [_ A]. apply negb_true_iff in A. rewrite A, andb_false_r. auto.
  - intros v A. apply andb_true_iff in A. destruct A as [_ A]. apply negb_true_iff in A. rewrite A, andb_false_r. auto.
  - intros v. cbn [Roles.two_faces threat_of]. destruct two; [reflexivity|]. simpl. intros A B.
    apply andb_true_iff in A, B. destruct A as [A A'], B as [_ B']. apply andb_true_iff in A. apply (D v); [apply Nat.ltb_lt; tauto|assumption|assumption].
  - exists i. destruct (Nat.ltb_spec i n); [|lia]. rewrite Si, Mi. reflexivity.
  - exists j. destruct (Nat.ltb_spec j n); [|lia]. rewrite Sj, Mj. reflexivity.
  - intros k. apply HELD. exact D1.
  - intros k. apply HELD. exact D2.
  - cbn [Roles.local threat_of]. change (most (threat_of hearers f two local)) with (f + 1 - 1). replace (f + 1 - 1) with f by lia.
    unfold obeys in BM. destruct local.
    + intros k K E. rewrite BIG in E by assumption. specialize (BM k K E). apply Nat.le_trans with (2 := BM). unfold size. simpl.
      apply cnt_le. intros v V Q. apply in_seq in V. rewrite BIG in Q by lia. exact Q.
    + apply Nat.le_trans with (2 := BM). unfold size. simpl. apply cnt_le. intros v V Q. apply in_seq in V. rewrite BIG in Q by lia. exact Q.
Qed.

Lemma refuted_together : forall hearers f two local body, keeps_together (threat_of hearers f two local) body = Refuted ->
  together (Digraph n h) f two local.
Proof.
  intros hearers f two local body R M S1 S2 A. apply (apart_solution hearers) in A.
  exact (keeps_together_sound n h _ _ (threat_sound hearers f two local) body R _ _ _ _ A).
Qed.

(* sets: the definition, clause by clause *)
Definition deaf (f : nat) (two : bool) (tm own : table unit) (l : list nat) : bool :=
  forallb (fun i => if has tm i then true else tally (fun j => negb (has own j || (two && has tm j))) (heard i) 0 <=? f) l.
Definition holds_apart (f : nat) (two local : bool) (m l1 l2 : list nat) : bool :=
  let tm := set_of m in
  let t1 := set_of l1 in
  let t2 := set_of l2 in
  ascending m && ascending l1 && ascending l2
  && forallb (fun i => i <? n) m && forallb (fun i => i <? n) l1 && forallb (fun i => i <? n) l2
  && forallb (fun i => negb (has t1 i)) l2
  && existsb (fun i => negb (has tm i)) l1 && existsb (fun i => negb (has tm i)) l2
  && forallb (fun i => if two then negb (has t1 i || has t2 i) else has t1 i || has t2 i) m
  && (if local then all_below n (fun i => if has tm i then true else tally (has tm) (heard i) 0 <=? f) else length_of m <=? f)
  && deaf f two tm t1 l1 && deaf f two tm t2 l2.

Lemma deaf_sound : forall f two tm l i, deaf f two tm (set_of l) l = true -> i < n -> has (set_of l) i = true -> has tm i = false ->
  size (Digraph n h) (fun j => h i j && negb (has (set_of l) j || (two && has tm j))) <= f.
Proof.
  intros f two tm l i F I H M. unfold deaf in F. rewrite forallb_forall in F. apply has_in in H. specialize (F i H). rewrite M in F.
  apply Nat.leb_le in F. rewrite tally_cnt, (heard_cnt n h heard h_range h_loop heard_ok) in F by assumption. exact F.
Qed.

Lemma holds_apart_sound : forall f two local m l1 l2, holds_apart f two local m l1 l2 = true ->
  apart (Digraph n h) f two local (has (set_of m)) (has (set_of l1)) (has (set_of l2)).
Proof.
  intros f two local m l1 l2 H. unfold holds_apart in H. cbv zeta in H. do 12 (apply andb_true_iff in H; destruct H as [H ?]).
  rename H into AM, H11 into A1, H10 into A2, H9 into BM, H8 into B1, H7 into B2, H6 into DIS, H5 into E1, H4 into E2, H3 into FA, H2 into LIM, H1 into D1, H0 into D2.
  rewrite forallb_forall in BM, B1, B2, DIS, FA.
  assert (SOME : forall l, (forall x, In x l -> (x <? n) = true) -> existsb (fun i => negb (has (set_of m) i)) l = true ->
    exists i, i < n /\ has (set_of l) i = true /\ has (set_of m) i = false).
  { intros l B E. apply existsb_exists in E. destruct E as (i & I & E). exists i. split; [apply Nat.ltb_lt; auto|].
    split; [apply has_in; assumption|apply negb_true_iff; assumption]. }
  split.
  - unfold obeys. destruct local.
    + intros i I M. simpl in I. pose proof (all_below_spec n _ LIM i I) as L. cbv beta in L. rewrite M in L. apply Nat.leb_le in L.
      rewrite tally_cnt, (heard_cnt n h heard h_range h_loop heard_ok) in L by assumption. exact L.
    + rewrite length_of_is in LIM. apply Nat.leb_le in LIM. apply Nat.le_trans with (2 := LIM). unfold size. simpl.
      rewrite <- (cnt_true m (fun _ => true)) by reflexivity. rewrite (cnt_incl m (ascending_nodup m AM) (seq 0 n) _ (seq_NoDup n 0)).
      * apply cnt_le. intros v _ V. rewrite has_set_of in V. rewrite V. reflexivity.
      * intros v V. apply BM in V. apply Nat.ltb_lt in V. apply in_seq. lia.
  - apply SOME; assumption.
  - apply SOME; assumption.
  - intros i _ X Y. apply has_in in Y. apply DIS in Y. rewrite X in Y. discriminate.
  - destruct two.
    + split; intros i _ X Y; apply has_in in X; apply FA in X; rewrite Y in X; rewrite ?orb_true_r in X; discriminate.
    + intros i _ X. apply has_in in X. apply FA in X. exact X.
  - intros i I X Y. apply deaf_sound; assumption.
  - intros i I X Y. apply deaf_sound; assumption.
Qed.
End Graph.
