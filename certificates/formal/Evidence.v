(* What each kind of evidence proves about a graph whose nodes are any list: Lemma 3 (degree), Lemma 4 (growth), and
   the bridge from violating pairs to the definition (Lemma 1). *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Soundness.
Import ListNotations.

Definition outside (V : list nat) (h : nat -> nat -> bool) (S : set) (i : nat) : nat := cnt V (fun j => h i j && negb (S j)).
Definition reach (V : list nat) (h : nat -> nat -> bool) (r : nat) (S : set) : set := fun i => S i && (r <=? outside V h S i).

(* No two sets of nodes in V violate (r,s)-robustness. *)
Definition no_pair (V : list nat) (h : nat -> nat -> bool) (r s : nat) : Prop :=
  forall S1 S2 : set, (exists i, In i V /\ S1 i = true) -> (exists i, In i V /\ S2 i = true) ->
  (forall i, In i V -> S1 i = true -> S2 i = true -> False) ->
  (forall i, In i V -> S1 i = true -> r <= outside V h S1 i) \/
  (forall i, In i V -> S2 i = true -> r <= outside V h S2 i) \/
  s <= cnt V (reach V h r S1) + cnt V (reach V h r S2).

Lemma no_pair_robust : forall G r s, (nodes G = 1 -> r <= 1) -> no_pair (seq 0 (nodes G)) (hears G) r s -> robust G r s.
Proof.
  intros G r s ONE NP. split; [assumption|]. intros S1 S2 (i & I & Si) (j & J & Sj) D.
  assert (R : forall S, (forall i, In i (seq 0 (nodes G)) -> S i = true -> r <= outside (seq 0 (nodes G)) (hears G) S i) ->
              same G (reachable G r S) S).
  { intros S H k K. unfold reachable. destruct (S k) eqn:E; [simpl|reflexivity]. apply Nat.leb_le. apply H; [|assumption].
    apply in_seq. lia. }
  destruct (NP S1 S2) as [N|[N|N]].
  - exists i. split; [apply in_seq; lia|assumption].
  - exists j. split; [apply in_seq; lia|assumption].
  - intros k K. apply in_seq in K. apply D. lia.
  - left. auto.
  - right. left. auto.
  - right. right. exact N.
Qed.

(* Either all members of S have r in-neighbours outside, or one has not. *)
Lemma all_or_one : forall V h r (S : set), (forall i, In i V -> S i = true -> r <= outside V h S i) \/
  (exists i, In i V /\ S i = true /\ outside V h S i < r).
Proof.
  intros V h r S. destruct (existsb (fun i => S i && (outside V h S i <? r)) V) eqn:E.
  - right. apply existsb_exists in E. destruct E as (i & I & E). apply andb_true_iff in E. destruct E as [E L].
    apply Nat.ltb_lt in L. eauto.
  - left. intros i I Si. destruct (le_lt_dec r (outside V h S i)) as [|L]; [assumption|exfalso].
    assert (existsb (fun i => S i && (outside V h S i <? r)) V = true); [|congruence].
    apply existsb_exists. exists i. split; [assumption|]. rewrite Si. apply Nat.ltb_lt. assumption.
Qed.

(* Lemma 1: where no violating pair of the format exists, no pair violates the definition. *)
Lemma lemma_1 : forall n h r s, (forall i v, h i v = true -> v < n) -> 1 <= r -> 1 <= s ->
  (forall X Y, violating n h (fun i => cnt (seq 0 n) (h i) + 1 - r) (s - 1) X Y -> False) -> no_pair (seq 0 n) h r s.
Proof.
  intros n h r s HR R1 S1' NV S1 S2 N1 N2 D. set (V := seq 0 n) in *. set (need := fun i => cnt V (h i) + 1 - r) in *.
  destruct (all_or_one V h r S1) as [|(i & I & Si & Oi)]; [auto|].
  destruct (all_or_one V h r S2) as [|(j & J & Sj & Oj)]; [auto|]. right. right.
  destruct (le_lt_dec s (cnt V (reach V h r S1) + cnt V (reach V h r S2))) as [|L]; [assumption|exfalso].
  set (cut := fun (S : set) (v : nat) => (v <? n) && S v).
  assert (CV : forall S v, In v V -> cut S v = S v).
  { intros S v Q. apply in_seq in Q. unfold cut. destruct (Nat.ltb_spec v n); [reflexivity|lia]. }
  assert (CI : forall S v, cut S v = true -> v < n /\ S v = true).
  { intros S v Q. apply andb_true_iff in Q. destruct Q as [Q1 Q2]. apply Nat.ltb_lt in Q1. auto. }
  assert (SPLIT : forall S k, inside n h (cut S) k + outside V h S k = cnt V (h k)).
  { intros S k. unfold inside, outside. fold V. rewrite (cnt_split V (h k) S). f_equal. apply cnt_ext. intros v Q.
    rewrite CV by assumption. reflexivity. }
  assert (SAT : forall S k, sat n h need (cut S) k = negb (r <=? outside V h S k)).
  { intros S k. pose proof (SPLIT S k) as P. unfold sat, need. destruct (Nat.leb_spec r (outside V h S k));
      [apply Nat.leb_gt|apply Nat.leb_le]; lia. }
  assert (EX : forall S, cnt V (exempt n h need (cut S)) = cnt V (reach V h r S)).
  { intros S. apply cnt_ext. intros v Q. unfold exempt, reach. rewrite SAT, CV, negb_involutive by assumption. reflexivity. }
  apply (NV (cut S1) (cut S2)). split.
  - intros v Q. apply CI in Q. tauto.
  - intros v Q. apply CI in Q. tauto.
  - intros v Q1 Q2. apply CI in Q1, Q2. apply (D v); [apply in_seq; lia| |]; tauto.
  - exists i. rewrite CV, SAT by assumption. split; [assumption|]. apply negb_true_iff. apply Nat.leb_gt. assumption.
  - exists j. rewrite CV, SAT by assumption. split; [assumption|]. apply negb_true_iff. apply Nat.leb_gt. assumption.
  - fold V. rewrite !EX. lia.
Qed.

(* Lemma 3. *)
Lemma lemma_3 : forall n h r s, (forall i, h i i = false) -> 1 <= r ->
  (forall i, i < n -> n / 2 + r - 1 <= cnt (seq 0 n) (h i)) -> no_pair (seq 0 n) h r s.
Proof.
  intros n h r s HL R1 DEG. set (V := seq 0 n) in *.
  assert (ONE : forall S : set, cnt V S <= n / 2 -> forall i, In i V -> S i = true -> r <= outside V h S i).
  { intros S C i I Si. assert (I' : i < n) by (apply in_seq in I; lia). specialize (DEG i I').
    rewrite (cnt_split V (h i) S) in DEG. fold (outside V h S i) in DEG.
    assert (cnt V (fun v => h i v && S v) < cnt V S); [|lia]. apply cnt_lt with i; [assumption| |assumption|rewrite HL; reflexivity].
    intros u _ Q. apply andb_true_iff in Q. tauto. }
  intros S1 S2 _ _ D. assert (T : cnt V S1 + cnt V S2 <= n).
  { apply Nat.le_trans with (cnt V (fun _ => true)).
    - rewrite !cnt_sum, <- sum_add. apply sum_le. intros v Q. specialize (D v Q).
      destruct (S1 v), (S2 v); simpl; try lia; destruct D; reflexivity.
    - pose proof (cnt_le_length V (fun _ => true)). unfold V in *. rewrite seq_length in *. assumption. }
  pose proof (Nat.div_mod_eq n 2). pose proof (Nat.mod_upper_bound n 2).
  destruct (le_lt_dec (cnt V S1) (n / 2)); [left; auto|]. right. left. apply ONE. lia.
Qed.

Lemma no_pair_ext : forall V h h' r s, (forall i j, In i V -> In j V -> h i j = h' i j) -> no_pair V h r s -> no_pair V h' r s.
Proof.
  intros V h h' r s E NP S1 S2 N1 N2 D.
  assert (O : forall S i, In i V -> outside V h' S i = outside V h S i)
    by (intros; apply cnt_ext; intros; rewrite E by assumption; reflexivity).
  assert (R : forall S, cnt V (reach V h' r S) = cnt V (reach V h r S))
    by (intros; apply cnt_ext; intros; unfold reach; rewrite O by assumption; reflexivity).
  rewrite !R. destruct (NP S1 S2 N1 N2 D) as [Q|[Q|Q]]; [left|right; left|right; right; exact Q];
    intros; rewrite O by assumption; auto.
Qed.

(* Numbering the nodes anew. *)
Lemma no_pair_map : forall V g h r s, no_pair V (fun i j => h (g i) (g j)) r s -> no_pair (map g V) h r s.
Proof.
  intros V g h r s NP S1 S2 (i & I & Si) (j & J & Sj) D. apply in_map_iff in I, J.
  destruct I as (i' & <- & I). destruct J as (j' & <- & J).
  assert (O : forall S k, outside (map g V) h S (g k) = outside V (fun i j => h (g i) (g j)) (fun v => S (g v)) k)
    by (intros; unfold outside; rewrite cnt_map; reflexivity).
  assert (R : forall S, cnt (map g V) (reach (map g V) h r S) = cnt V (reach V (fun i j => h (g i) (g j)) r (fun v => S (g v))))
    by (intros; rewrite cnt_map; apply cnt_ext; intros; unfold reach; rewrite O; reflexivity).
  destruct (NP (fun v => S1 (g v)) (fun v => S2 (g v))) as [Q|[Q|Q]]; eauto.
  - intros k K. apply D. apply in_map. assumption.
  - left. intros k K Sk. apply in_map_iff in K. destruct K as (k' & <- & K). rewrite O. auto.
  - right. left. intros k K Sk. apply in_map_iff in K. destruct K as (k' & <- & K). rewrite O. auto.
  - right. right. rewrite !R. assumption.
Qed.

(* Lemma 4: a new node x that hears at least r + s - 1 nodes of V. *)
Lemma grow_one : forall V x h r s (S1 S2 : set), ~ In x V -> (forall i, h i i = false) -> no_pair V h r s -> 1 <= r ->
  r + s - 1 <= cnt V (h x) -> S1 x = true ->
  (exists i, In i V /\ S2 i = true) -> (forall i, In i (x :: V) -> S1 i = true -> S2 i = true -> False) ->
  (forall i, In i (x :: V) -> S1 i = true -> r <= outside (x :: V) h S1 i) \/
  (forall i, In i (x :: V) -> S2 i = true -> r <= outside (x :: V) h S2 i) \/
  s <= cnt (x :: V) (reach (x :: V) h r S1) + cnt (x :: V) (reach (x :: V) h r S2).
Proof.
  intros V x h r s S1 S2 NX HL NP R1 DEG SX N2 D.
  assert (O1 : forall i, outside (x :: V) h S1 i = outside V h S1 i).
  { intros i. unfold outside. rewrite cnt_cons, SX, andb_false_r. reflexivity. }
  assert (O2 : forall S i, outside V h S i <= outside (x :: V) h S i) by (intros; unfold outside; rewrite cnt_cons; lia).
  assert (R2 : forall S, cnt V (reach V h r S) <= cnt (x :: V) (reach (x :: V) h r S)).
  { intros S. rewrite cnt_cons. apply Nat.le_trans with (cnt V (reach (x :: V) h r S)); [|lia]. apply cnt_le.
    intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q1 Q2]. unfold reach. rewrite Q1. apply Nat.leb_le in Q2.
    apply Nat.leb_le. specialize (O2 S v). lia. }
  assert (SPLIT : cnt V (h x) = cnt V (fun v => h x v && S1 v) + outside V h S1 x) by apply cnt_split.
  destruct (existsb S1 V) eqn:E.
  - apply existsb_exists in E. destruct (NP S1 S2) as [Q|[Q|Q]]; [destruct E as (i & I & Si); eauto|assumption| | | |].
    + intros i I. apply D. right. assumption.
    + destruct (le_lt_dec r (outside V h S1 x)) as [L|L].
      * left. intros i [<-|I] Si; rewrite O1; auto.
      * right. right. assert (s <= cnt (x :: V) (reach (x :: V) h r S1)); [|lia].
        rewrite cnt_cons. apply Nat.le_trans with (cnt V (reach (x :: V) h r S1)); [|lia].
        apply Nat.le_trans with (cnt V (fun v => h x v && S1 v)); [lia|]. apply cnt_le. intros v I P.
        apply andb_true_iff in P. destruct P as [_ P]. unfold reach. rewrite P, O1. apply Nat.leb_le. auto.
    + right. left. intros i [<-|I] Si; [exfalso; apply (D x); simpl; auto|]. specialize (Q i I Si). specialize (O2 S2 i). lia.
    + right. right. pose proof (R2 S1). pose proof (R2 S2). lia.
  - assert (Z : forall v, In v V -> S1 v = false).
    { intros v I. destruct (S1 v) eqn:Sv; [|reflexivity]. rewrite <- E. symmetry. apply existsb_exists. eauto. }
    destruct s as [|s]; [right; right; lia|]. left. intros i [<-|I] Si; [|rewrite Z in Si by assumption; discriminate].
    rewrite O1.
    assert (cnt V (fun v => h x v && S1 v) = 0); [|lia]. apply cnt_false. intros v I. rewrite Z by assumption. apply andb_false_r.
Qed.

Lemma lemma_4 : forall V x h r s, ~ In x V -> (forall i, h i i = false) -> no_pair V h r s -> 1 <= r ->
  r + s - 1 <= cnt V (h x) -> no_pair (x :: V) h r s.
Proof.
  intros V x h r s NX HL NP R1 DEG S1 S2 (i & I & Si) (j & J & Sj) D.
  destruct (S1 x) eqn:X1.
  - apply grow_one; auto. destruct J as [<-|J]; [exfalso; apply (D x); simpl; auto|eauto].
  - destruct (S2 x) eqn:X2.
    + rewrite Nat.add_comm. enough (forall A B C : Prop, A \/ B \/ C -> B \/ A \/ C) as SW.
      * apply SW. apply grow_one; auto.
        -- destruct I as [<-|I]; [congruence|eauto].
        -- intros k K A B. apply (D k); assumption.
      * tauto.
    + assert (O2 : forall S i, outside V h S i <= outside (x :: V) h S i) by (intros; unfold outside; rewrite cnt_cons; lia).
      assert (R2 : forall S, cnt V (reach V h r S) <= cnt (x :: V) (reach (x :: V) h r S)).
      { intros S. rewrite cnt_cons. apply Nat.le_trans with (cnt V (reach (x :: V) h r S)); [|lia]. apply cnt_le.
        intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q1 Q2]. unfold reach. rewrite Q1. apply Nat.leb_le in Q2.
        apply Nat.leb_le. specialize (O2 S v). lia. }
      destruct I as [<-|I]; [congruence|]. destruct J as [<-|J]; [congruence|].
      destruct (NP S1 S2) as [Q|[Q|Q]]; eauto.
      * intros k K. apply D. right. assumption.
      * left. intros k [<-|K] Sk; [congruence|]. specialize (Q k K Sk). specialize (O2 S1 k). lia.
      * right. left. intros k [<-|K] Sk; [congruence|]. specialize (Q k K Sk). specialize (O2 S2 k). lia.
      * right. right. pose proof (R2 S1). pose proof (R2 S2). lia.
Qed.

Lemma no_pair_same_nodes : forall V W h r s, NoDup V -> NoDup W -> (forall i, In i V <-> In i W) -> no_pair V h r s -> no_pair W h r s.
Proof.
  intros V W h r s NV NW E NP.
  assert (C : forall f, cnt W f = cnt V f).
  { intros f. rewrite (cnt_incl W NW V f NV) by (intros v I; apply E; assumption). apply cnt_ext. intros v I.
    replace (existsb (Nat.eqb v) W) with true; [reflexivity|]. symmetry. apply existsb_exists. exists v.
    split; [apply E; assumption|apply Nat.eqb_refl]. }
  assert (R : forall S, cnt W (reach W h r S) = cnt V (reach V h r S))
    by (intros; rewrite C; apply cnt_ext; intros; unfold reach, outside; rewrite C; reflexivity).
  intros S1 S2 (i & I & Si) (j & J & Sj) D. rewrite !R. unfold outside. 
  destruct (NP S1 S2) as [Q|[Q|Q]].
  - exists i. split; [apply E|]; assumption.
  - exists j. split; [apply E|]; assumption.
  - intros k K. apply D. apply E. assumption.
  - left. intros k K Sk. rewrite C. apply Q; [apply E|]; assumption.
  - right. left. intros k K Sk. rewrite C. apply Q; [apply E|]; assumption.
  - right. right. assumption.
Qed.
