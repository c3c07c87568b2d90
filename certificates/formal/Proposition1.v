(* Proposition 1, corrected, for every f: a 2f-robust network whose in-degrees are 3f or more, that is also
   (f+1,s)-robust for every s, and that has a trap for f (docs/constructions.md, two_f_robust_counterexample). *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Sets Robustness Evidence Apart Traps.
Import ListNotations.

Lemma cnt_three : forall l f g1 g2 g3, (forall v, In v l -> Nat.b2n (f v) = Nat.b2n (g1 v) + Nat.b2n (g2 v) + Nat.b2n (g3 v)) ->
  cnt l f = cnt l g1 + cnt l g2 + cnt l g3.
Proof.
  intros l f g1 g2 g3 H. rewrite !cnt_sum, <- !sum_add. induction l as [|v l IH]; [reflexivity|]. simpl.
  rewrite IH by (intros; apply H; right; assumption). rewrite (H v) by (left; reflexivity). reflexivity.
Qed.

(* Two cliques P and Q of f + 1 nodes, each joined to c nodes of the other, and 2f - c nodes U that are joined to all. *)
Record two_cliques (V : list nat) (h L : nat -> nat -> bool) (U P Q : set) (f c : nat) : Prop := {
  one_each : forall j, In j V -> Nat.b2n (U j) + Nat.b2n (P j) + Nat.b2n (Q j) = 1;
  many_U : cnt V U = 2 * f - c;
  many_P : cnt V P = f + 1;
  many_Q : cnt V Q = f + 1;
  hear_U : forall i j, In i V -> In j V -> U i = true -> h i j = negb (j =? i);
  hear_P : forall i j, In i V -> In j V -> P i = true -> h i j = U j || (P j && negb (j =? i)) || (Q j && L i j);
  hear_Q : forall i j, In i V -> In j V -> Q i = true -> h i j = U j || (Q j && negb (j =? i)) || (P j && L j i);
  row_sum : forall i, In i V -> P i = true -> cnt V (fun j => Q j && L i j) = c;
  column_sum : forall j, In j V -> Q j = true -> cnt V (fun i => P i && L i j) = c }.

Lemma two_cliques_swap : forall V h L U P Q f c, two_cliques V h L U P Q f c -> two_cliques V h (fun i j => L j i) U Q P f c.
Proof. intros V h L U P Q f c []. split; auto. intros j J. specialize (one_each0 j J). lia. Qed.

(* What a set without nodes of U lacks of a clique. *)
Definition lacks (V : list nat) (P B : set) : nat := cnt V (fun j => P j && negb (B j)).

(* A member of P in a set B without nodes of U, when it hears at most 2f - 1 nodes outside. *)
Lemma member_of_P : forall V h L U P Q f c B i, two_cliques V h L U P Q f c -> c <= f ->
  (forall j, In j V -> B j = true -> U j = false) -> In i V -> P i = true -> B i = true -> outside V h B i < 2 * f ->
  lacks V P B + cnt V (fun j => Q j && L i j && negb (B j)) + 1 <= c /\ lacks V P B + lacks V Q B <= f /\
  exists j, In j V /\ Q j = true /\ B j = true.
Proof.
  intros V h L U P Q f c B i T C NU I Pi Bi O. destruct T.
  assert (E : outside V h B i = cnt V U + lacks V P B + cnt V (fun j => Q j && L i j && negb (B j))).
  { apply cnt_three. intros j J. rewrite (hear_P0 i j I J Pi). specialize (one_each0 j J). specialize (NU j J).
    destruct (Nat.eqb_spec j i) as [->|]; [rewrite Bi, Pi in *; destruct (U i), (Q i), (L i i); simpl in *; lia|].
    destruct (U j), (P j), (Q j), (L i j), (B j); simpl in *; try lia; discriminate (NU eq_refl). }
  pose proof (row_sum0 i I Pi) as R. rewrite (cnt_split V _ B) in R.
  pose proof many_Q0 as K. rewrite (cnt_split V Q B) in K. fold (lacks V Q B) in K.
  assert (M : cnt V (fun j => Q j && L i j && B j) <= cnt V (fun j => Q j && B j)).
  { apply cnt_le. intros j _ X. destruct (Q j), (L i j), (B j); simpl in *; auto. }
  split; [lia|]. split; [lia|]. destruct (existsb (fun j => Q j && B j) V) eqn:X.
  - apply existsb_exists in X. destruct X as (j & J & X). apply andb_true_iff in X. exists j. tauto.
  - assert (cnt V (fun j => Q j && B j) = 0); [|lia]. apply cnt_false. intros j J. destruct (Q j && B j) eqn:Y; [|reflexivity].
    rewrite <- X. symmetry. apply existsb_exists. exists j. auto.
Qed.

(* It cannot lack c - 1 nodes of P and one of Q: that one is heard by a member of P. *)
Lemma not_that_many : forall V h L U P Q f c B, two_cliques V h L U P Q f c -> c <= f ->
  (forall j, In j V -> B j = true -> U j = false) -> (forall i, In i V -> B i = true -> outside V h B i < 2 * f) ->
  lacks V P B < c -> c <= lacks V P B + 1 -> 1 <= lacks V Q B -> False.
Proof.
  intros V h L U P Q f c B T C NU O A1 A2 A3.
  destruct (existsb (fun j => Q j && negb (B j)) V) eqn:X.
  - apply existsb_exists in X. destruct X as (y & Y & X). apply andb_true_iff in X. destruct X as [Qy By].
    pose proof (column_sum _ _ _ _ _ _ _ _ T y Y Qy) as R. rewrite (cnt_split V _ B) in R.
    assert (M : cnt V (fun i => P i && L i y && negb (B i)) <= lacks V P B).
    { apply cnt_le. intros j _ Z. destruct (P j), (L j y), (B j); simpl in *; auto. }
    destruct (existsb (fun i => P i && L i y && B i) V) eqn:Z.
    + apply existsb_exists in Z. destruct Z as (x & W & Z). apply andb_true_iff in Z. destruct Z as [Z Bx].
      apply andb_true_iff in Z. destruct Z as [Px Lx].
      destruct (member_of_P V h L U P Q f c B x T C NU W Px Bx (O x W Bx)) as [E _].
      assert (1 <= cnt V (fun j => Q j && L x j && negb (B j))); [|lia].
      apply cnt_pos with y; [assumption|]. rewrite Qy, Lx. exact By.
    + assert (cnt V (fun i => P i && L i y && B i) = 0); [|lia]. apply cnt_false. intros j J.
      destruct (P j && L j y && B j) eqn:W; [|reflexivity]. rewrite <- Z. symmetry. apply existsb_exists. exists j. auto.
  - assert (lacks V Q B = 0); [|lia]. apply cnt_false. intros j J. destruct (Q j && negb (B j)) eqn:Y; [|reflexivity].
    rewrite <- X. symmetry. apply existsb_exists. exists j. auto.
Qed.

(* Both cliques: what such a set lacks of them. *)
Lemma lacks_little : forall V h L U P Q f c B, two_cliques V h L U P Q f c -> c <= f ->
  (forall j, In j V -> B j = true -> U j = false) -> (forall i, In i V -> B i = true -> outside V h B i < 2 * f) ->
  (exists i, In i V /\ B i = true) ->
  lacks V P B < c /\ lacks V Q B < c /\ lacks V P B + lacks V Q B <= f.
Proof.
  intros V h L U P Q f c B T C NU O (i & I & Bi). pose proof (two_cliques_swap _ _ _ _ _ _ _ _ T) as T'.
  assert (HP : forall i, In i V -> P i = true -> B i = true -> lacks V P B < c /\ lacks V P B + lacks V Q B <= f /\
            exists j, In j V /\ Q j = true /\ B j = true).
  { intros x X Px Bx. destruct (member_of_P V h L U P Q f c B x T C NU X Px Bx (O x X Bx)) as (E1 & E2 & E3).
    split; [lia|auto]. }
  assert (HQ : forall i, In i V -> Q i = true -> B i = true -> lacks V Q B < c /\ exists j, In j V /\ P j = true /\ B j = true).
  { intros x X Qx Bx. destruct (member_of_P V h _ U Q P f c B x T' C NU X Qx Bx (O x X Bx)) as (E1 & _ & E3). split; [lia|auto]. }
  specialize (one_each _ _ _ _ _ _ _ _ T i I) as E. rewrite (NU i I Bi) in E.
  destruct (P i) eqn:Pi.
  - destruct (HP i I Pi Bi) as (A1 & A2 & j & J & Qj & Bj). destruct (HQ j J Qj Bj). auto.
  - destruct (Q i) eqn:Qi; [|discriminate]. destruct (HQ i I Qi Bi) as (A1 & j & J & Pj & Bj). destruct (HP j J Pj Bj). tauto.
Qed.

Lemma cnt_disjoint : forall V (A B X : set), (forall i, In i V -> A i = true -> B i = true -> False) ->
  cnt V (fun v => X v && A v) + cnt V (fun v => X v && B v) <= cnt V X.
Proof.
  intros V A B X D. rewrite !cnt_sum, <- sum_add. apply sum_le. intros v I. specialize (D v I).
  destruct (X v), (A v), (B v); simpl; lia.
Qed.

(* A node of U hears all nodes outside its set; so that a set with one is large. *)
Lemma large : forall V h L U P Q f c B i, two_cliques V h L U P Q f c -> c <= 2 * f -> In i V -> U i = true -> B i = true ->
  outside V h B i < 2 * f -> length V < cnt V B + 2 * f.
Proof.
  intros V h L U P Q f c B i T C I Ui Bi O.
  assert (E : outside V h B i = cnt V (fun j => true && negb (B j))).
  { apply cnt_ext. intros j J. rewrite (hear_U _ _ _ _ _ _ _ _ T i j I J Ui). destruct (Nat.eqb_spec j i) as [->|]; [rewrite Bi|]; reflexivity. }
  assert (N : cnt V (fun _ => true) = length V) by (apply cnt_true; reflexivity).
  rewrite (cnt_split V _ B) in N. simpl in N. simpl in E. change (fun v => B v) with B in N. lia.
Qed.

Lemma two_cliques_length : forall V h L U P Q f c, two_cliques V h L U P Q f c -> c <= 2 * f -> length V = 4 * f + 2 - c.
Proof.
  intros V h L U P Q f c [] C. rewrite <- (cnt_true V (fun _ => true)) by reflexivity.
  rewrite (cnt_three V _ U P Q); [lia|]. intros j J. rewrite one_each0 by assumption. reflexivity.
Qed.

(* One of two disjoint sets has a node with 2f in-neighbours outside; here when B has no node of U. *)
Lemma split_one : forall V h L U P Q f c A B, two_cliques V h L U P Q f c -> c <= f -> c <= 3 ->
  (exists i, In i V /\ A i = true) -> (exists i, In i V /\ B i = true) ->
  (forall i, In i V -> A i = true -> B i = true -> False) ->
  (forall i, In i V -> A i = true -> outside V h A i < 2 * f) -> (forall i, In i V -> B i = true -> outside V h B i < 2 * f) ->
  (forall j, In j V -> B j = true -> U j = false) -> False.
Proof.
  intros V h L U P Q f c A B T C C3 NA NB D OA OB NU. pose proof (two_cliques_swap _ _ _ _ _ _ _ _ T) as T'.
  destruct (lacks_little V h L U P Q f c B T C NU OB NB) as (B1 & B2 & B3).
  pose proof (many_P _ _ _ _ _ _ _ _ T) as MP. pose proof (many_Q _ _ _ _ _ _ _ _ T) as MQ.
  assert (SP : forall S, cnt V (fun j => P j && S j) + lacks V P S = f + 1) by (intros S; rewrite <- MP; symmetry; apply cnt_split).
  assert (SQ : forall S, cnt V (fun j => Q j && S j) + lacks V Q S = f + 1) by (intros S; rewrite <- MQ; symmetry; apply cnt_split).
  destruct (existsb (fun j => A j && U j) V) eqn:X.
  - apply existsb_exists in X. destruct X as (i & I & X). apply andb_true_iff in X. destruct X as [Ai Ui].
    pose proof (large V h L U P Q f c A i T ltac:(lia) I Ui Ai (OA i I Ai)) as LA.
    rewrite (two_cliques_length _ _ _ _ _ _ _ _ T) in LA by lia.
    assert (LB : cnt V A + cnt V B <= 4 * f + 2 - c).
    { rewrite <- (two_cliques_length _ _ _ _ _ _ _ _ T) by lia.
      rewrite <- (cnt_true V (fun _ => true)) by reflexivity. exact (cnt_disjoint V A B (fun _ => true) D). }
    assert (EB : cnt V B = cnt V (fun j => false && B j) + cnt V (fun j => P j && B j) + cnt V (fun j => Q j && B j)).
    { apply cnt_three. intros j J. pose proof (one_each _ _ _ _ _ _ _ _ T j J) as E. destruct (B j) eqn:Bj.
      - rewrite (NU j J Bj) in E. destruct (P j), (Q j); simpl in *; lia.
      - rewrite !andb_false_r. reflexivity. }
    rewrite (cnt_false V (fun j => false && B j)) in EB by reflexivity.
    specialize (SP B). specialize (SQ B).
    destruct (le_lt_dec c (lacks V P B + 1)) as [Z|Z].
    + apply (not_that_many V h L U P Q f c B T C NU OB); lia.
    + apply (not_that_many V h _ U Q P f c B T' C NU OB); lia.
  - assert (NU' : forall j, In j V -> A j = true -> U j = false).
    { intros j J Aj. destruct (U j) eqn:Uj; [|reflexivity]. rewrite <- X. symmetry. apply existsb_exists. exists j.
      rewrite Aj, Uj. auto. }
    destruct (lacks_little V h L U P Q f c A T C NU' OA NA) as (A1 & A2 & A3).
    pose proof (cnt_disjoint V A B P D) as DP. pose proof (cnt_disjoint V A B Q D) as DQ.
    pose proof (SP A). pose proof (SP B). pose proof (SQ A). pose proof (SQ B). lia.
Qed.

Lemma two_cliques_no_pair : forall V h L U P Q f c, two_cliques V h L U P Q f c -> 1 <= c -> c <= f -> c <= 3 -> no_pair V h (2 * f) 1.
Proof.
  intros V h L U P Q f c T C1 C C3 A B NA NB D.
  destruct (le_lt_dec 1 (cnt V (reach V h (2 * f) A) + cnt V (reach V h (2 * f) B))) as [|Z]; [auto|exfalso].
  assert (O : forall S, cnt V (reach V h (2 * f) S) = 0 -> forall i, In i V -> S i = true -> outside V h S i < 2 * f).
  { intros S E i I Si. destruct (le_lt_dec (2 * f) (outside V h S i)) as [G|G]; [|assumption].
    assert (1 <= cnt V (reach V h (2 * f) S)); [|lia]. apply cnt_pos with i; [assumption|]. unfold reach. rewrite Si.
    apply Nat.leb_le. assumption. }
  assert (OA : forall i, In i V -> A i = true -> outside V h A i < 2 * f) by (apply O; lia).
  assert (OB : forall i, In i V -> B i = true -> outside V h B i < 2 * f) by (apply O; lia).
  destruct (existsb (fun j => B j && U j) V) eqn:X.
  - apply existsb_exists in X. destruct X as (i & I & X). apply andb_true_iff in X. destruct X as [Bi Ui].
    apply (split_one V h L U P Q f c B A T C C3 NB NA); try assumption.
    + intros k K Bk Ak. exact (D k K Ak Bk).
    + intros j J Aj. destruct (U j) eqn:Uj; [exfalso|reflexivity].
      pose proof (large V h L U P Q f c A j T ltac:(lia) J Uj Aj (OA j J Aj)) as LA.
      pose proof (large V h L U P Q f c B i T ltac:(lia) I Ui Bi (OB i I Bi)) as LB.
      pose proof (two_cliques_length _ _ _ _ _ _ _ _ T ltac:(lia)) as N.
      assert (cnt V A + cnt V B <= length V); [|lia].
      rewrite <- (cnt_true V (fun _ => true)) by reflexivity. exact (cnt_disjoint V A B (fun _ => true) D).
  - apply (split_one V h L U P Q f c A B T C C3 NA NB); try assumption.
    intros j J Bj. destruct (U j) eqn:Uj; [|reflexivity]. rewrite <- X. symmetry. apply existsb_exists. exists j.
    rewrite Bj, Uj. auto.
Qed.

(* Counting in an interval, and around a circle. *)
Definition interval (low many j : nat) : bool := (low <=? j) && (j <? low + many).

Lemma cnt_interval : forall n low many F, low + many <= n ->
  cnt (seq 0 n) (fun j => interval low many j && F (j - low)) = cnt (seq 0 many) F.
Proof.
  intros n low many F N. replace n with (low + (many + (n - low - many))) by lia. rewrite !cnt_seq_app.
  rewrite (cnt_false (seq 0 low)), (cnt_false (seq 0 (n - low - many))).
  - rewrite Nat.add_0_l, Nat.add_0_r. apply cnt_ext. intros v I. apply in_seq in I. unfold interval.
    destruct (Nat.leb_spec low (low + v)), (Nat.ltb_spec (low + v) (low + many)); try lia. simpl. f_equal. lia.
  - intros v I. unfold interval. destruct (Nat.ltb_spec (low + (many + v)) (low + many)); [lia|]. rewrite andb_false_r. reflexivity.
  - intros v I. apply in_seq in I. unfold interval. destruct (Nat.leb_spec low v); [lia|reflexivity].
Qed.

Lemma cnt_turned : forall F m, cnt (seq 0 m) (fun a => F (m - 1 - a)) = cnt (seq 0 m) F.
Proof.
  intros F m. induction m as [|m IH]; [reflexivity|].
  assert (A : cnt (seq 0 (1 + m)) (fun a => F (m - a)) = cnt (seq 0 1) (fun a => F (m - a)) + cnt (seq 0 m) (fun a => F (m - (1 + a))))
    by apply cnt_seq_app.
  assert (B : cnt (seq 0 (m + 1)) F = cnt (seq 0 m) F + cnt (seq 0 1) (fun a => F (m + a))) by apply cnt_seq_app.
  rewrite (Nat.add_comm m 1), <- IH in B. change (1 + m) with (S m) in A, B. rewrite B.
  rewrite (cnt_ext _ _ (fun a => F (m - a))) by (intros; f_equal; lia). rewrite A, Nat.add_comm. f_equal.
  - apply cnt_ext. intros v _. f_equal. lia.
  - unfold cnt. simpl. rewrite Nat.sub_0_r, Nat.add_0_r. reflexivity.
Qed.

Lemma around : forall k a b, a < k -> b < k -> (b + k - a) mod k = if a <=? b then b - a else b + k - a.
Proof.
  intros k a b A B. destruct (Nat.leb_spec a b).
  - replace (b + k - a) with (b - a + 1 * k) by lia. rewrite Nat.mod_add by lia. apply Nat.mod_small. lia.
  - apply Nat.mod_small. lia.
Qed.

Lemma cnt_row : forall F k a, a < k -> cnt (seq 0 k) (fun b => F ((b + k - a) mod k)) = cnt (seq 0 k) F.
Proof.
  intros F k a A. replace (seq 0 k) with (seq 0 (a + (k - a))) at 1 by (f_equal; lia).
  replace (seq 0 k) with (seq 0 (k - a + a)) by (f_equal; lia). rewrite !cnt_seq_app, Nat.add_comm. f_equal.
  - apply cnt_ext. intros v I. apply in_seq in I. rewrite around by lia. destruct (Nat.leb_spec a (a + v)); [|lia]. f_equal. lia.
  - apply cnt_ext. intros v I. apply in_seq in I. rewrite around by lia. destruct (Nat.leb_spec a v); [lia|]. f_equal. lia.
Qed.

Lemma cnt_column : forall F k b, b < k -> cnt (seq 0 k) (fun a => F ((b + k - a) mod k)) = cnt (seq 0 k) F.
Proof.
  intros F k b B. replace (seq 0 k) with (seq 0 (S b + (k - S b))) by (f_equal; lia). rewrite !cnt_seq_app. f_equal.
  - rewrite <- (cnt_turned F (S b)). apply cnt_ext. intros v I. apply in_seq in I. rewrite around by lia.
    destruct (Nat.leb_spec v b); [|lia]. f_equal. lia.
  - rewrite <- (cnt_turned (fun i => F (S b + i)) (k - S b)). apply cnt_ext. intros v I. apply in_seq in I. rewrite around by lia.
    destruct (Nat.leb_spec (S b + v) b); [lia|]. f_equal. lia.
Qed.

(* The family: f nodes M, the cliques S1 and S2 of f + 1 nodes, and from f = 4 on f - 3 nodes R. Node a of S1 and node b
   of S2 hear each other when b - a is 1, 2 or 3 around a circle of f + 1: for f <= 3 when b is not a. *)
Definition M (f : nat) : set := fun j => j <? f.
Definition S1 (f : nat) : set := interval f (f + 1).
Definition S2 (f : nat) : set := interval (2 * f + 1) (f + 1).
Definition linked (f a b : nat) : bool := let m := (b + (f + 1) - a) mod (f + 1) in (1 <=? m) && (m <=? 3).
Definition across (f i j : nat) : bool := linked f (i - f) (j - (2 * f + 1)).
Definition corrected (f : nat) : digraph :=
  Digraph (3 * f + 2 + (f - 3)) (fun i j =>
    negb (j =? i) && (if S1 f i && S2 f j then across f i j else if S2 f i && S1 f j then across f j i else true)).

Lemma linked_many : forall f, cnt (seq 0 (f + 1)) (fun m => (1 <=? m) && (m <=? 3)) = Nat.min f 3.
Proof.
  intros f. destruct (le_lt_dec f 3) as [L|L].
  - destruct f as [|[|[|[|f]]]]; try reflexivity. lia.
  - replace (f + 1) with (4 + (f - 3)) by lia. rewrite cnt_seq_app, (cnt_false (seq 0 (f - 3))).
    + rewrite Nat.min_r by lia. reflexivity.
    + intros v _. destruct (Nat.leb_spec (4 + v) 3); [lia|]. apply andb_false_r.
Qed.

Lemma interval_true : forall low many j, interval low many j = true <-> low <= j /\ j < low + many.
Proof. intros. unfold interval. rewrite andb_true_iff, Nat.leb_le, Nat.ltb_lt. reflexivity. Qed.

Lemma cnt_interval_all : forall n low many, low + many <= n -> cnt (seq 0 n) (interval low many) = many.
Proof.
  intros n low many N. pose proof (cnt_interval n low many (fun _ => true) N) as C. rewrite (cnt_true (seq 0 many)), seq_length in C by reflexivity.
  rewrite <- C at 2. apply cnt_ext. intros. symmetry. apply andb_true_r.
Qed.

Lemma corrected_cliques : forall f, 1 <= f ->
  two_cliques (seq 0 (nodes (corrected f))) (hears (corrected f)) (across f) (fun j => negb (S1 f j || S2 f j)) (S1 f) (S2 f) f (Nat.min f 3).
Proof.
  intros f F. set (V := seq 0 (nodes (corrected f))). assert (NV : V = seq 0 (3 * f + 2 + (f - 3))) by reflexivity.
  assert (D : forall j, S1 f j = true -> S2 f j = false).
  { intros j A. apply interval_true in A. apply not_true_is_false. intros B. apply interval_true in B. lia. }
  assert (P1 : cnt V (S1 f) = f + 1) by (rewrite NV; apply cnt_interval_all; lia).
  assert (P2 : cnt V (S2 f) = f + 1) by (rewrite NV; apply cnt_interval_all; lia).
  assert (ONE : forall j, Nat.b2n (negb (S1 f j || S2 f j)) + Nat.b2n (S1 f j) + Nat.b2n (S2 f j) = 1).
  { intros j. specialize (D j). destruct (S1 f j); [rewrite D by reflexivity; reflexivity|]. destruct (S2 f j); reflexivity. }
  split; try assumption.
  - intros j _. apply ONE.
  - assert (N : cnt V (fun _ => true) = cnt V (fun j => negb (S1 f j || S2 f j)) + cnt V (S1 f) + cnt V (S2 f)).
    { apply cnt_three. intros j _. rewrite ONE. reflexivity. }
    rewrite cnt_true in N by reflexivity. rewrite NV, seq_length, <- NV in N. lia.
  - intros i j _ _ U. apply negb_true_iff, orb_false_iff in U. destruct U as [U1 U2]. simpl. rewrite U1, U2. simpl. apply andb_true_r.
  - intros i j _ _ Pi. simpl. rewrite Pi, (D i Pi). simpl. specialize (D j). destruct (S1 f j) eqn:Pj.
    + rewrite D by reflexivity. simpl. rewrite andb_true_r, orb_false_r. reflexivity.
    + destruct (S2 f j) eqn:Qj; simpl.
      * destruct (Nat.eqb_spec j i) as [->|]; [congruence|reflexivity].
      * destruct (Nat.eqb_spec j i) as [->|]; [congruence|reflexivity].
  - intros i j _ _ Qi. assert (Pi : S1 f i = false) by (destruct (S1 f i) eqn:E; [rewrite D in Qi by assumption; discriminate|reflexivity]).
    simpl. rewrite Pi, Qi. simpl. specialize (D j). destruct (S1 f j) eqn:Pj; simpl.
    + rewrite D by reflexivity. destruct (Nat.eqb_spec j i) as [->|]; [congruence|reflexivity].
    + destruct (S2 f j) eqn:Qj; simpl; [rewrite andb_true_r, orb_false_r; reflexivity|].
      destruct (Nat.eqb_spec j i) as [->|]; [congruence|reflexivity].
  - intros i _ Pi. apply interval_true in Pi. rewrite NV.
    etransitivity; [exact (cnt_interval (3 * f + 2 + (f - 3)) (2 * f + 1) (f + 1) (linked f (i - f)) ltac:(lia))|].
    etransitivity; [exact (cnt_row (fun m => (1 <=? m) && (m <=? 3)) (f + 1) (i - f) ltac:(lia))|]. apply linked_many.
  - intros j _ Qj. apply interval_true in Qj. rewrite NV.
    etransitivity; [exact (cnt_interval (3 * f + 2 + (f - 3)) f (f + 1) (fun a => linked f a (j - (2 * f + 1))) ltac:(lia))|].
    etransitivity; [exact (cnt_column (fun m => (1 <=? m) && (m <=? 3)) (f + 1) (j - (2 * f + 1)) ltac:(lia))|]. apply linked_many.
Qed.

Lemma all_but_one : forall V X i, NoDup V -> In i V -> X i = true -> cnt V (fun j => X j && negb (j =? i)) + 1 = cnt V X.
Proof.
  intros V X i N I Xi. rewrite (cnt_split V X (fun j => j =? i)).
  rewrite (cnt_ext V (fun v => X v && (v =? i)) (fun v => (v =? i) && X v)) by (intros; apply andb_comm).
  rewrite cnt_one by assumption. rewrite Xi. simpl. lia.
Qed.

(* Whom a member of a clique hears. *)
Lemma heard_by_member : forall V h L U P Q f c i, two_cliques V h L U P Q f c -> c <= f -> NoDup V -> In i V -> P i = true ->
  cnt V (h i) = 3 * f /\ outside V h P i = 2 * f.
Proof.
  intros V h L U P Q f c i T C N I Pi. pose proof (row_sum _ _ _ _ _ _ _ _ T i I Pi) as R.
  pose proof (all_but_one V P i N I Pi) as A. rewrite (many_P _ _ _ _ _ _ _ _ T) in A. pose proof (many_U _ _ _ _ _ _ _ _ T) as MU. split.
  - rewrite (cnt_three V (h i) U (fun j => P j && negb (j =? i)) (fun j => Q j && L i j)); [lia|]. intros j J.
    rewrite (hear_P _ _ _ _ _ _ _ _ T i j I J Pi). pose proof (one_each _ _ _ _ _ _ _ _ T j J).
    destruct (U j), (P j), (Q j), (L i j), (j =? i); simpl in *; lia.
  - unfold outside. rewrite (cnt_three V _ U (fun j => false) (fun j => Q j && L i j)); [rewrite (cnt_false V (fun _ => false)) by reflexivity; lia|].
    intros j J. rewrite (hear_P _ _ _ _ _ _ _ _ T i j I J Pi). pose proof (one_each _ _ _ _ _ _ _ _ T j J).
    destruct (U j), (P j), (Q j), (L i j), (j =? i); simpl in *; lia.
Qed.

Lemma corrected_degree : forall f i, 1 <= f -> i < nodes (corrected f) -> 3 * f <= size (corrected f) (hears (corrected f) i).
Proof.
  intros f i F I. pose proof (corrected_cliques f F) as T. unfold size. set (V := seq 0 (nodes (corrected f))) in *.
  assert (NV : NoDup V) by apply seq_NoDup. assert (IV : In i V) by (apply in_seq; lia).
  destruct (S1 f i) eqn:E1; [rewrite (proj1 (heard_by_member _ _ _ _ _ _ _ _ i T ltac:(lia) NV IV E1)); lia|].
  destruct (S2 f i) eqn:E2.
  - rewrite (proj1 (heard_by_member _ _ _ _ _ _ _ _ i (two_cliques_swap _ _ _ _ _ _ _ _ T) ltac:(lia) NV IV E2)). lia.
  - assert (Ui : negb (S1 f i || S2 f i) = true) by (rewrite E1, E2; reflexivity).
    pose proof (all_but_one V (fun _ => true) i NV IV eq_refl) as A. rewrite (cnt_true V (fun _ => true)) in A by reflexivity.
    pose proof (two_cliques_length _ _ _ _ _ _ _ _ T ltac:(lia)) as LEN.
    rewrite (cnt_ext V (hears (corrected f) i) (fun j => true && negb (j =? i)))
      by (intros j J; apply (hear_U _ _ _ _ _ _ _ _ T i j IV J Ui)). lia.
Qed.

Lemma corrected_deaf : forall f i, 1 <= f -> i < nodes (corrected f) -> forall P, (P = S1 f \/ P = S2 f) -> P i = true ->
  size (corrected f) (fun j => hears (corrected f) i j && negb (P j || M f j)) <= f.
Proof.
  intros f i F I P WHICH Pi. pose proof (corrected_cliques f F) as T. unfold size. set (V := seq 0 (nodes (corrected f))) in *.
  assert (IV : In i V) by (apply in_seq; lia).
  assert (G : forall P Q L, two_cliques V (hears (corrected f)) L (fun j => negb (S1 f j || S2 f j)) P Q f (Nat.min f 3) -> P i = true ->
    cnt V (fun j => hears (corrected f) i j && negb (P j || M f j)) <= f).
  { clear P WHICH Pi T. intros P Q L T Pi. pose proof (row_sum _ _ _ _ _ _ _ _ T i IV Pi) as R.
    assert (C : cnt V (interval (3 * f + 2) (f - 3)) = f - 3) by (apply cnt_interval_all; simpl; lia).
    assert (cnt V (fun j => hears (corrected f) i j && negb (P j || M f j)) <=
            cnt V (interval (3 * f + 2) (f - 3)) + cnt V (fun j => Q j && L i j)); [|lia].
    rewrite !cnt_sum, <- sum_add. apply sum_le. intros j J. rewrite (hear_P _ _ _ _ _ _ _ _ T i j IV J Pi).
    pose proof (one_each _ _ _ _ _ _ _ _ T j J) as E.
    assert (W : negb (S1 f j || S2 f j) = true -> M f j = false -> interval (3 * f + 2) (f - 3) j = true).
    { intros A B. apply in_seq in J. simpl in J. apply negb_true_iff, orb_false_iff in A. destruct A as [A1 A2].
      apply Nat.ltb_ge in B. apply interval_true. unfold S1, S2, interval in A1, A2.
      destruct (Nat.leb_spec f j), (Nat.ltb_spec j (f + (f + 1))), (Nat.leb_spec (2 * f + 1) j),
        (Nat.ltb_spec j (2 * f + 1 + (f + 1))); simpl in *; try discriminate; lia. }
    destruct (negb (S1 f j || S2 f j)), (P j), (Q j), (L i j), (M f j), (j =? i); simpl in *; try lia; rewrite W by reflexivity; simpl; lia. }
  destruct WHICH as [-> | ->]; [apply (G _ _ _ T Pi)|apply (G _ _ _ (two_cliques_swap _ _ _ _ _ _ _ _ T) Pi)].
Qed.

Theorem proposition_1_corrected : forall f, 1 <= f ->
  robust (corrected f) (2 * f) 1 /\ (forall s, robust (corrected f) (f + 1) s) /\ ~ robust (corrected f) (2 * f + 1) 1 /\
  (forall i, i < nodes (corrected f) -> 3 * f <= size (corrected f) (hears (corrected f) i)) /\
  trap (corrected f) f (M f) (S1 f) (S2 f).
Proof.
  intros f F. pose proof (corrected_cliques f F) as T. pose proof (two_cliques_length _ _ _ _ _ _ _ _ T ltac:(lia)) as LEN.
  rewrite seq_length in LEN. assert (N : 5 <= nodes (corrected f)) by lia. set (n := nodes (corrected f)) in *.
  pose proof (Nat.div_mod_eq n 2) as DIV. pose proof (Nat.mod_upper_bound n 2) as MOD.
  assert (X1 : nonempty (corrected f) (S1 f)) by (exists f; split; [fold n; lia|apply interval_true; lia]).
  assert (X2 : nonempty (corrected f) (S2 f)) by (exists (2 * f + 1); split; [fold n; lia|apply interval_true; lia]).
  assert (DIS : disjoint (corrected f) (S1 f) (S2 f)) by (intros i _ A B; apply interval_true in A, B; lia).
  split; [|split; [|split; [|split]]].
  - apply no_pair_robust; [fold n; lia|]. apply (two_cliques_no_pair _ _ _ _ _ _ _ _ T); lia.
  - intros s. apply no_pair_robust; [fold n; lia|]. fold n. apply lemma_3; [intros i; simpl; rewrite Nat.eqb_refl; reflexivity|lia|].
    intros i I. pose proof (corrected_degree f i F I) as G. unfold size in G. fold n in G. lia.
  - intros [_ R]. destruct (R (S1 f) (S2 f) X1 X2 DIS) as [Q|[Q|Q]].
    + destruct X1 as (i & I & Pi). specialize (Q i I). unfold reachable in Q. rewrite Pi, andb_true_l in Q. apply Nat.leb_le in Q.
      destruct (heard_by_member _ _ _ _ _ _ _ _ i T ltac:(lia) (seq_NoDup _ _) ltac:(apply in_seq; lia) Pi) as [_ O].
      unfold outside in O. unfold size in Q. fold n in Q. lia.
    + destruct X2 as (i & I & Pi). specialize (Q i I). unfold reachable in Q. rewrite Pi, andb_true_l in Q. apply Nat.leb_le in Q.
      destruct (heard_by_member _ _ _ _ _ _ _ _ i (two_cliques_swap _ _ _ _ _ _ _ _ T) ltac:(lia) (seq_NoDup _ _) ltac:(apply in_seq; lia) Pi) as [_ O].
      unfold outside in O. unfold size in Q. fold n in Q. lia.
    + unfold size in Q. rewrite !cnt_false in Q; [lia| |]; intros i I; unfold reachable.
      * destruct (S2 f i) eqn:Pi; [|reflexivity]. rewrite andb_true_l. apply Nat.leb_gt.
        destruct (heard_by_member _ _ _ _ _ _ _ _ i (two_cliques_swap _ _ _ _ _ _ _ _ T) ltac:(lia) (seq_NoDup _ _) I Pi) as [_ O].
        unfold outside in O. unfold size. fold n. lia.
      * destruct (S1 f i) eqn:Pi; [|reflexivity]. rewrite andb_true_l. apply Nat.leb_gt.
        destruct (heard_by_member _ _ _ _ _ _ _ _ i T ltac:(lia) (seq_NoDup _ _) I Pi) as [_ O].
        unfold outside in O. unfold size. fold n. lia.
  - intros i I. apply corrected_degree; assumption.
  - assert (OFF : forall low, f <= low -> forall i, M f i = true -> interval low (f + 1) i = true -> False).
    { intros low L i A B. unfold M in A. apply Nat.ltb_lt in A. apply interval_true in B. lia. }
    assert (NM : forall S, nonempty (corrected f) S -> (forall i, M f i = true -> S i = true -> False) ->
      exists i, i < nodes (corrected f) /\ S i = true /\ M f i = false).
    { intros S (i & I & Si) D. exists i. split; [assumption|]. split; [assumption|]. apply not_true_is_false. intros Mi. exact (D i Mi Si). }
    split.
    + unfold obeys, size. rewrite (cnt_ext _ (M f) (interval 0 f)) by (intros; reflexivity). rewrite cnt_interval_all; [lia|simpl; lia].
    + apply NM; [assumption|apply OFF; lia].
    + apply NM; [assumption|apply OFF; lia].
    + assumption.
    + split; intros i _; apply OFF; lia.
    + intros i I Pi _. apply (corrected_deaf f i F I (S1 f)); auto.
    + intros i I Pi _. apply (corrected_deaf f i F I (S2 f)); auto.
Qed.
