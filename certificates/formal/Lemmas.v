(* Lemmas that the toolkit leans on elsewhere, by their names in docs/lemma-1.md, docs/certificate-format.md and
   docs/theorems.md. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Soundness Evidence.
Import ListNotations.

Lemma robust_no_pair : forall G r s, robust G r s -> no_pair (seq 0 (nodes G)) (hears G) r s.
Proof.
  intros G r s [_ R] S1 S2 (i & I & Si) (j & J & Sj) D. apply in_seq in I, J.
  assert (SAME : forall S, Robustness.same G (reachable G r S) S ->
            forall k, In k (seq 0 (nodes G)) -> S k = true -> r <= outside (seq 0 (nodes G)) (hears G) S k).
  { intros S E k K Sk. apply in_seq in K. assert (E' : reachable G r S k = S k) by (apply E; lia). unfold reachable in E'.
    rewrite Sk in E'. simpl in E'. apply Nat.leb_le in E'. exact E'. }
  destruct (R S1 S2) as [Q|[Q|Q]]; [exists i; split; [lia|assumption]|exists j; split; [lia|assumption]| | | |].
  - intros k K. apply D. apply in_seq. lia.
  - left. apply SAME. assumption.
  - right. left. apply SAME. assumption.
  - right. right. exact Q.
Qed.

(* Lemma 1 (i), for sets of nodes and for graphs. *)
Lemma no_pair_weaker : forall V h r s r' s', r' <= r -> s' <= s -> no_pair V h r s -> no_pair V h r' s'.
Proof.
  intros V h r s r' s' R S NP S1 S2 N1 N2 D. destruct (NP S1 S2 N1 N2 D) as [Q|[Q|Q]].
  - left. intros i I Si. specialize (Q i I Si). lia.
  - right. left. intros i I Si. specialize (Q i I Si). lia.
  - right. right. assert (M : forall X, cnt V (reach V h r X) <= cnt V (reach V h r' X)).
    { intros X. apply cnt_le. intros v _ P. apply andb_true_iff in P. destruct P as [P1 P2]. apply Nat.leb_le in P2.
      unfold reach. rewrite P1. apply Nat.leb_le. lia. }
    pose proof (M S1). pose proof (M S2). lia.
Qed.
Theorem lemma_1_i : forall G r s r' s', r' <= r -> s' <= s -> robust G r s -> robust G r' s'.
Proof.
  intros G r s r' s' R S RO. apply no_pair_robust.
  - intros O. destruct RO as [ONE _]. specialize (ONE O). lia.
  - apply (no_pair_weaker _ _ r s); [assumption|assumption|]. apply robust_no_pair. assumption.
Qed.

(* Lemma 1 (ii): taking a reached node out of a set. *)
Definition without (S : set) (y : nat) : set := fun v => S v && negb (v =? y).

Lemma outside_without : forall V h X y i, NoDup V -> outside V h (without X y) i <= S (outside V h X i).
Proof.
  intros V h X y i N. unfold outside.
  rewrite (cnt_split V (fun j => h i j && negb (without X y j)) (fun j => j =? y)).
  assert (A : cnt V (fun j => h i j && negb (without X y j) && (j =? y)) <= 1).
  { apply Nat.le_trans with (cnt V (fun j => (j =? y) && true)).
    - apply cnt_le. intros v _ Q. apply andb_true_iff in Q. destruct Q as [_ Q]. rewrite Q. reflexivity.
    - destruct (in_dec Nat.eq_dec y V); [rewrite (cnt_one V y (fun _ => true)) by assumption; reflexivity|].
      rewrite cnt_false; [lia|]. intros v I. destruct (Nat.eqb_spec v y); [subst; contradiction|reflexivity]. }
  assert (B : cnt V (fun j => h i j && negb (without X y j) && negb (j =? y)) <= cnt V (fun j => h i j && negb (X j))).
  { apply cnt_le. intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q NE]. apply andb_true_iff in Q. destruct Q as [Q1 Q2].
    rewrite Q1. unfold without in Q2. rewrite NE, andb_true_r in Q2. exact Q2. }
  lia.
Qed.

(* If y in S1 hears r nodes outside and not all of S1 hear r - 1, then the pair without y is one that violates less. *)
Lemma take_out : forall V h r s (S1 S2 : set) y, NoDup V -> no_pair V h (S r) s -> 1 <= s -> In y V ->
  reach V h (S r) S1 y = true -> (exists i, In i V /\ S1 i = true /\ outside V h S1 i < r) ->
  (exists i, In i V /\ S2 i = true /\ outside V h S2 i < r) ->
  (forall i, In i V -> S1 i = true -> S2 i = true -> False) ->
  S s <= cnt V (reach V h r S1) + cnt V (reach V h r S2).
Proof.
  intros V h r s S1 S2 y N NP S Y RY (i & I & Si & Oi) (j & J & Sj & Oj) D.
  assert (NEQ : i <> y). { intros ->. apply andb_true_iff in RY. destruct RY as [_ RY]. apply Nat.leb_le in RY. lia. }
  assert (WI : without S1 y i = true) by (unfold without; rewrite Si; apply negb_true_iff, Nat.eqb_neq; assumption).
  destruct (NP (without S1 y) S2) as [Q|[Q|Q]]; eauto.
  - intros k K A B. apply andb_true_iff in A. destruct A as [A _]. eauto.
  - specialize (Q i I WI). pose proof (outside_without V h S1 y i N). lia.
  - specialize (Q j J Sj). lia.
  - assert (L1 : cnt V (reach V h (Datatypes.S r) (without S1 y)) < cnt V (reach V h r S1)).
    { apply cnt_lt with y; [assumption| | |].
      - intros u _ P. apply andb_true_iff in P. destruct P as [P1 P2]. apply andb_true_iff in P1. destruct P1 as [P1 _].
        apply Nat.leb_le in P2. pose proof (outside_without V h S1 y u N). unfold reach. rewrite P1. apply Nat.leb_le. lia.
      - apply andb_true_iff in RY. destruct RY as [R1 R2]. unfold reach. rewrite R1. apply Nat.leb_le in R2.
        apply Nat.leb_le. lia.
      - unfold reach, without. rewrite Nat.eqb_refl, andb_false_r. reflexivity. }
    assert (L2 : cnt V (reach V h (Datatypes.S r) S2) <= cnt V (reach V h r S2)).
    { apply cnt_le. intros u _ P. apply andb_true_iff in P. destruct P as [P1 P2]. apply Nat.leb_le in P2.
      unfold reach. rewrite P1. apply Nat.leb_le. lia. }
    lia.
Qed.

Lemma some_reached : forall V h r S, 1 <= cnt V (reach V h r S) -> exists y, In y V /\ reach V h r S y = true.
Proof.
  intros V h r S C. destruct (existsb (reach V h r S) V) eqn:E; [apply existsb_exists in E; exact E|].
  rewrite cnt_false in C; [lia|]. intros v I. destruct (reach V h r S v) eqn:Q; [|reflexivity].
  rewrite <- E. symmetry. apply existsb_exists. eauto.
Qed.

Lemma no_pair_trade : forall V h r s, NoDup V -> 1 <= s -> no_pair V h (S r) s -> no_pair V h r (S s).
Proof.
  intros V h r s N S NP S1 S2 N1 N2 D.
  destruct (all_or_one V h r S1) as [|E1]; [auto|]. destruct (all_or_one V h r S2) as [|E2]; [auto|]. right. right.
  destruct (NP S1 S2 N1 N2 D) as [Q|[Q|Q]].
  - destruct E1 as (i & I & Si & Oi). specialize (Q i I Si). lia.
  - destruct E2 as (i & I & Si & Oi). specialize (Q i I Si). lia.
  - destruct (le_lt_dec 1 (cnt V (reach V h (Datatypes.S r) S1))) as [L|L].
    + apply some_reached in L. destruct L as (y & Y & RY). apply take_out with y; assumption.
    + assert (L' : 1 <= cnt V (reach V h (Datatypes.S r) S2)) by lia.
      apply some_reached in L'. destruct L' as (y & Y & RY). rewrite Nat.add_comm. apply take_out with y; try assumption.
      intros k K A B. apply (D k); assumption.
Qed.
Theorem lemma_1_ii : forall G r s, 1 <= r -> 1 <= s -> robust G r s -> robust G (r - 1) (s + 1).
Proof.
  intros G r s R S RO. apply no_pair_robust.
  - intros O. destruct RO as [ONE _]. specialize (ONE O). lia.
  - replace (s + 1) with (Datatypes.S s) by lia. apply no_pair_trade; [apply seq_NoDup|assumption|].
    replace (Datatypes.S (r - 1)) with r by lia. apply robust_no_pair. assumption.
Qed.

(* (i) and (ii) together: what a claim implies, by which `verify` answers a question. *)
Lemma trade : forall k G r t, 1 <= t -> 1 <= r -> robust G (r + k) t -> robust G r (t + k).
Proof.
  induction k as [|k IH]; intros G r t T R RO; [rewrite Nat.add_0_r in *; assumption|].
  replace (t + S k) with ((t + 1) + k) by lia. apply IH; [lia|assumption|].
  replace (r + k) with (r + S k - 1) by lia. apply lemma_1_ii; [lia|assumption|assumption].
Qed.
Theorem weaken : forall G r s r' s', 1 <= s -> r' <= r -> s' <= s + r - r' -> robust G r s -> robust G r' s'.
Proof.
  intros G r s r' s' S R B RO. destruct r' as [|r'].
  - split; [lia|]. intros S1 S2 _ _ _. left. intros i _. unfold reachable. apply andb_true_r.
  - apply (lemma_1_i G (Datatypes.S r') (s + (r - Datatypes.S r'))); [lia|lia|]. apply trade; [assumption|lia|].
    replace (Datatypes.S r' + (r - Datatypes.S r')) with r by lia. assumption.
Qed.

(* Lemma 1, last line. *)
Theorem lemma_1_last : forall s G r, 1 <= s -> 1 <= r -> robust G (r + s - 1) 1 -> robust G r s.
Proof.
  intros s G r S R RO. replace s with (1 + (s - 1)) by lia. apply trade; [lia|assumption|].
  replace (r + (s - 1)) with (r + s - 1) by lia. assumption.
Qed.

(* Lemma 1 (v): r is at most ceil(n/2); and complete graphs attain it for every s. *)
Theorem lemma_1_v : forall G r s, 1 <= nodes G -> 1 <= s -> robust G r s -> r <= (nodes G + 1) / 2.
Proof.
  intros G r s N S RO. set (n := nodes G) in *.
  pose proof (Nat.div_mod_eq (n + 1) 2) as E. pose proof (Nat.mod_upper_bound (n + 1) 2) as B.
  destruct (Nat.eq_dec n 1) as [O|O]; [destruct RO as [ONE _]; specialize (ONE O); lia|].
  destruct (le_lt_dec r ((n + 1) / 2)) as [|L]; [assumption|exfalso]. set (m := (n + 1) / 2) in *.
  apply robust_no_pair in RO. fold n in RO.
  assert (O1 : forall i, outside (seq 0 n) (hears G) (fun v => v <? m) i <= n - m).
  { intros i. unfold outside. replace n with (m + (n - m)) at 1 by lia. rewrite seq_app, cnt_app, cnt_false.
    - pose proof (cnt_le_length (seq (0 + m) (n - m)) (fun j => hears G i j && negb (j <? m))). rewrite seq_length in *. lia.
    - intros v I. apply in_seq in I. destruct (Nat.ltb_spec v m); [apply andb_false_r|lia]. }
  assert (O2 : forall i, outside (seq 0 n) (hears G) (fun v => negb (v <? m)) i <= m).
  { intros i. unfold outside. replace n with (m + (n - m)) at 1 by lia.
    rewrite seq_app, cnt_app, (cnt_false (seq (0 + m) (n - m))).
    - pose proof (cnt_le_length (seq 0 m) (fun j => hears G i j && negb (negb (j <? m)))). rewrite seq_length in *. lia.
    - intros v I. apply in_seq in I. destruct (Nat.ltb_spec v m); [lia|apply andb_false_r]. }
  assert (Z : forall X, (forall i, outside (seq 0 n) (hears G) X i < r) -> cnt (seq 0 n) (reach (seq 0 n) (hears G) r X) = 0).
  { intros X H. apply cnt_false. intros v _. unfold reach. specialize (H v).
    destruct (Nat.leb_spec r (outside (seq 0 n) (hears G) X v)); [lia|apply andb_false_r]. }
  destruct (RO (fun v => v <? m) (fun v => negb (v <? m))) as [Q|[Q|Q]].
  - exists 0. split; [apply in_seq; lia|apply Nat.ltb_lt; lia].
  - exists (n - 1). split; [apply in_seq; lia|]. destruct (Nat.ltb_spec (n - 1) m); [lia|reflexivity].
  - intros i _ A B'. rewrite A in B'. discriminate.
  - assert (X : r <= n - m); [|lia]. apply Nat.le_trans with (2 := O1 0). apply Q; [apply in_seq; lia|apply Nat.ltb_lt; lia].
  - assert (X : r <= m); [|lia]. apply Nat.le_trans with (2 := O2 (n - 1)). apply Q; [apply in_seq; lia|].
    destruct (Nat.ltb_spec (n - 1) m); [lia|reflexivity].
  - rewrite !Z in Q; [lia| |]; intros i; [specialize (O2 i)|specialize (O1 i)]; lia.
Qed.

Definition complete (n : nat) : digraph := Digraph n (fun i j => negb (j =? i)).
Theorem lemma_1_v_complete : forall n r s, 1 <= r -> r <= (n + 1) / 2 -> robust (complete n) r s.
Proof.
  intros n r s R B. pose proof (Nat.div_mod_eq (n + 1) 2) as E. pose proof (Nat.mod_upper_bound (n + 1) 2) as M.
  pose proof (Nat.div_mod_eq n 2) as E'. pose proof (Nat.mod_upper_bound n 2) as M'.
  apply no_pair_robust; [simpl; lia|]. apply lemma_3; [|assumption|].
  - intros i. simpl. rewrite Nat.eqb_refl. reflexivity.
  - change (nodes (complete n)) with n. intros i I. change (hears (complete n) i) with (fun j => negb (j =? i)).
    assert (C : cnt (seq 0 n) (fun _ => true) = n) by (rewrite cnt_true, seq_length; reflexivity).
    rewrite (cnt_split _ _ (fun j => j =? i)) in C.
    rewrite (cnt_ext _ (fun v => true && (v =? i)) (fun v => (v =? i) && true)) in C by (intros; destruct (v =? i); reflexivity).
    rewrite (cnt_one (seq 0 n) i (fun _ => true)) in C; [|apply seq_NoDup|apply in_seq; lia].
    cbn [Nat.b2n] in C. change (fun v => true && negb (v =? i)) with (fun v => negb (v =? i)) in C. lia.
Qed.

(* Lemma 1 (vi): when no node loses more than w in-arcs. *)
Lemma no_pair_fewer : forall V h h' r s w, (forall i j, h' i j = true -> h i j = true) ->
  (forall i, In i V -> cnt V (fun j => h i j && negb (h' i j)) <= w) -> no_pair V h r s -> no_pair V h' (r - w) s.
Proof.
  intros V h h' r s w SUB LOSS NP S1 S2 N1 N2 D.
  assert (O : forall S i, In i V -> outside V h S i <= outside V h' S i + w).
  { intros S i I. unfold outside. rewrite (cnt_split V (fun j => h i j && negb (S j)) (h' i)). apply Nat.add_le_mono.
    - apply cnt_le. intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q Q3]. apply andb_true_iff in Q. destruct Q as [_ Q2].
      rewrite Q3. exact Q2.
    - apply Nat.le_trans with (2 := LOSS i I). apply cnt_le. intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q Q3].
      apply andb_true_iff in Q. destruct Q as [Q _]. rewrite Q. exact Q3. }
  destruct (NP S1 S2 N1 N2 D) as [Q|[Q|Q]].
  - left. intros i I Si. specialize (Q i I Si). specialize (O S1 i I). lia.
  - right. left. intros i I Si. specialize (Q i I Si). specialize (O S2 i I). lia.
  - right. right. assert (M : forall X, cnt V (reach V h r X) <= cnt V (reach V h' (r - w) X)).
    { intros X. apply cnt_le. intros v I P. apply andb_true_iff in P. destruct P as [P1 P2]. apply Nat.leb_le in P2.
      unfold reach. rewrite P1. apply Nat.leb_le. specialize (O X v I). lia. }
    pose proof (M S1). pose proof (M S2). lia.
Qed.
Theorem lemma_1_vi : forall G G' r s w, nodes G' = nodes G -> (forall i j, hears G' i j = true -> hears G i j = true) ->
  (forall i, i < nodes G -> size G (fun j => hears G i j && negb (hears G' i j)) <= w) -> robust G r s -> robust G' (r - w) s.
Proof.
  intros G G' r s w N SUB LOSS RO. apply no_pair_robust.
  - intros O. destruct RO as [ONE _]. rewrite N in O. specialize (ONE O). lia.
  - rewrite N. apply (no_pair_fewer _ (hears G)); [assumption| |apply robust_no_pair; assumption].
    intros i I. apply LOSS. apply in_seq in I. lia.
Qed.

(* Lemma 1 (vii), in its sharper form: a new node, number n, that hears at least r + s - 1 others. *)
Theorem lemma_1_vii : forall G G' r s, 1 <= nodes G -> 1 <= r -> nodes G' = S (nodes G) -> (forall i, hears G' i i = false) ->
  (forall i j, i < nodes G -> j < nodes G -> hears G' i j = hears G i j) ->
  r + s - 1 <= size G (hears G' (nodes G)) -> robust G r s -> robust G' r s.
Proof.
  intros G G' r s N R N' LOOP SAME DEG RO. apply no_pair_robust; [lia|]. rewrite N'.
  apply (no_pair_same_nodes (nodes G :: seq 0 (nodes G))).
  - constructor; [|apply seq_NoDup]. intros I. apply in_seq in I. lia.
  - apply seq_NoDup.
  - intros i. simpl. rewrite !in_seq. lia.
  - apply lemma_4; [|assumption| |assumption|exact DEG].
    + intros I. apply in_seq in I. lia.
    + apply (no_pair_ext _ (hears G)); [|apply robust_no_pair; assumption]. intros i j I J. apply in_seq in I, J.
      symmetry. apply SAME; lia.
Qed.

(* Sets without an r-reachable node are closed under union. *)
Theorem union_unreached : forall G r (A B : set), (forall i, i < nodes G -> reachable G r A i = false) ->
  (forall i, i < nodes G -> reachable G r B i = false) -> forall i, i < nodes G -> reachable G r (fun v => A v || B v) i = false.
Proof.
  intros G r A B HA HB i I. specialize (HA i I). specialize (HB i I). unfold reachable in *.
  assert (M : forall X : set, (forall v, X v = true -> A v || B v = true) ->
    size G (fun j => hears G i j && negb (A j || B j)) <= size G (fun j => hears G i j && negb (X j))).
  { intros X H. apply cnt_le. intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q1 Q2]. rewrite Q1. simpl.
    destruct (X v) eqn:E; [rewrite (H v E) in Q2; discriminate|reflexivity]. }
  pose proof (M A (fun v E => orb_true_intro _ _ (or_introl E))) as MA.
  pose proof (M B (fun v E => orb_true_intro _ _ (or_intror E))) as MB.
  destruct (A i) eqn:Ai; simpl in *; [apply Nat.leb_gt in HA; apply Nat.leb_gt; lia|].
  destruct (B i) eqn:Bi; simpl in *; [apply Nat.leb_gt in HB; apply Nat.leb_gt; lia|reflexivity].
Qed.

(* The need form of the definition: a member is reachable when it hears fewer members than max(0, d - r + 1). *)
Theorem need_form : forall G r S i, S i = true ->
  reachable G r S i = (size G (fun j => hears G i j && S j) <? size G (hears G i) + 1 - r).
Proof.
  intros G r S i Si. unfold reachable. rewrite Si. unfold size. simpl.
  pose proof (cnt_split (seq 0 (nodes G)) (hears G i) S) as E.
  destruct (Nat.leb_spec r (cnt (seq 0 (nodes G)) (fun j => hears G i j && negb (S j)))); symmetry;
    [apply Nat.ltb_lt|apply Nat.ltb_ge]; lia.
Qed.
