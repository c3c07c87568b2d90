(* Every rule keeps the violating pairs that a state stands for, or finds that there are none. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Sets Rules.
Import ListNotations.

Section Question.
Variable n : nat.                       (* nodes *)
Variable h : nat -> nat -> bool.        (* h i v: i hears v *)
Variable needs : nat -> nat.            (* k_i *)
Variable spare : nat.                   (* s - 1 *)
Hypothesis h_range : forall i v, h i v = true -> v < n.
Hypothesis h_loop : forall i, h i i = false.

Notation all := (seq 0 n).
Definition inside (X : nat -> bool) (i : nat) : nat := cnt all (fun v => h i v && X v).
Definition sat (X : nat -> bool) (i : nat) : bool := needs i <=? inside X i.
Definition exempt (X : nat -> bool) (i : nat) : bool := X i && negb (sat X i).

(* A violating pair, by Lemma 1 of the format. *)
Record violating (X Y : nat -> bool) : Prop := {
  in_X : forall v, X v = true -> v < n;
  in_Y : forall v, Y v = true -> v < n;
  apart : forall v, X v = true -> Y v = true -> False;
  sat_X : exists v, X v = true /\ sat X v = true;
  sat_Y : exists v, Y v = true /\ sat Y v = true;
  few : cnt all (exempt X) + cnt all (exempt Y) <= spare }.

Lemma violating_swap : forall X Y, violating X Y -> violating Y X.
Proof. intros X Y []. split; eauto. lia. Qed.

(* A set X may be the one of side [a]. *)
Record stands (X : nat -> bool) (a : side) : Prop := {
  on_C : forall v, X v = true -> mem (sC a) v = true;
  on_P : forall v, X v = true -> sat X v = true -> mem (sP a) v = true;
  on_F : forall v, mem (sF a) v = true -> X v = true;
  on_T : forall v, mem (sT a) v = true -> X v = true /\ sat X v = true }.

(* The further exempt nodes of a side, those not in F \ P, and their number. *)
Definition further (X : nat -> bool) (P F : bits) (v : nat) : bool := exempt X v && negb (mem F v && negb (mem P v)).
Definition spend (X : nat -> bool) (a : side) : nat := cnt all (further X (sP a) (sF a)).

(* The bounds b, b_1, b_2. *)
Definition bounded (X Y : nat -> bool) (a b : side) (left la lb : nat) : Prop :=
  spend X a + spend Y b <= left /\ spend X a <= la /\ spend Y b <= lb.

(* What a row says of its node. [width]: words of a set. *)
Record row_ok (x : row) : Prop := {
  ok_hear : forall v, mem (hear x) v = h (id x) v;
  ok_wide : size * length (hear x) >= n;
  ok_self : forall v, mem (self x) v = true <-> v = id x;
  ok_need : need x = needs (id x) }.

Lemma count_hear : forall x D, row_ok x -> count 0 (hear x) D = cnt all (fun v => h (id x) v && mem D v).
Proof.
  intros x D O. rewrite (count_spec _ _ _ (size * length (hear x))) by lia. simpl. rewrite (cnt_seq_cut n).
  - apply cnt_ext. intros v _. rewrite (ok_hear x O). reflexivity.
  - apply (ok_wide x O).
  - intros v V. rewrite (ok_hear x O). destruct (h (id x) v) eqn:H; [|reflexivity]. apply h_range in H. lia.
Qed.

Lemma smaller_min : forall a b, smaller a b = Nat.min a b.
Proof. intros. unfold smaller. destruct (Nat.leb_spec a b); lia. Qed.

(* When P shrinks and F grows, no new further exempt nodes come up. *)
Lemma further_less : forall X P F P' F', (forall v, mem P' v = true -> mem P v = true) ->
  (forall v, mem F v = true -> mem F' v = true) -> cnt all (further X P' F') <= cnt all (further X P F).
Proof.
  intros X P F P' F' HP HF. apply cnt_le. intros v _. unfold further. intros A.
  apply andb_true_iff in A. destruct A as [A B]. rewrite A. simpl.
  destruct (mem F v) eqn:f; simpl; [|reflexivity]. destruct (mem P v) eqn:p; simpl; [reflexivity|].
  rewrite (HF v f) in B. destruct (mem P' v) eqn:p'; simpl in B; [rewrite (HP v p') in p; discriminate|discriminate].
Qed.

(* How many members a node can hear, when the satisfied ones are in Q. *)
Lemma inside_parts : forall X a Q t i, stands X a -> (forall v, X v = true -> sat X v = true -> mem Q v = true) ->
  spend X a <= t ->
  let D := union Q (sF a) in
  inside X i = cnt all (fun v => h i v && X v && mem D v) + cnt all (fun v => h i v && X v && negb (mem D v)) /\
  cnt all (fun v => h i v && X v && mem D v) <= cnt all (fun v => h i v && mem D v) /\
  cnt all (fun v => h i v && X v && negb (mem D v)) <= cnt all (fun v => h i v && mem (diff (sC a) D) v) /\
  cnt all (fun v => h i v && X v && negb (mem D v)) <= t.
Proof.
  intros X a Q t i ST HQ B D. split; [|split; [|split]].
  - unfold inside. apply (cnt_split all (fun v => h i v && X v)).
  - apply cnt_le. intros v _ A. repeat (apply andb_true_iff in A; destruct A as [A ?]). apply andb_true_iff; auto.
  - apply cnt_le. intros v _ A. repeat (apply andb_true_iff in A; destruct A as [A ?]).
    rewrite A, mem_diff, (on_C X a ST v H0), H. reflexivity.
  - apply Nat.le_trans with (2 := B). apply cnt_le. intros v _ A. repeat (apply andb_true_iff in A; destruct A as [A ?]).
    unfold D in H. rewrite mem_union in H. apply negb_true_iff, orb_false_iff in H. destruct H as [q f].
    unfold further, exempt. rewrite H0, f. simpl. rewrite andb_true_r. apply negb_true_iff.
    destruct (sat X v) eqn:s; [rewrite (HQ v H0 s) in q; discriminate|reflexivity].
Qed.

Lemma inside_reach : forall X a Q t x, stands X a -> (forall v, X v = true -> sat X v = true -> mem Q v = true) ->
  spend X a <= t -> row_ok x ->
  let D := union Q (sF a) in
  inside X (id x) <= count 0 (hear x) D + smaller (count 0 (hear x) (diff (sC a) D)) t.
Proof.
  intros X a Q t x ST HQ B O D. pose proof (inside_parts X a Q t (id x) ST HQ B) as (E & A1 & A2 & A3).
  rewrite !count_hear, smaller_min by assumption. fold D in E, A1, A2, A3. lia.
Qed.

Lemma unsat : forall X x b, row_ok x -> inside X (id x) <= b -> b < need x -> sat X (id x) = false.
Proof. intros. unfold sat. apply Nat.leb_gt. rewrite <- (ok_need x) by assumption. lia. Qed.

(* *peel* and *force* *)
Definition fine (X : nat -> bool) (P F : bits) : Prop :=
  (forall v, X v = true -> sat X v = true -> mem P v = true) /\ (forall v, mem F v = true -> X v = true).
Definition finer (X : nat -> bool) (P F P' F' : bits) : Prop :=
  fine X P' F' /\ (forall v, mem P' v = true -> mem P v = true) /\ (forall v, mem F v = true -> mem F' v = true).

Lemma finer_refl : forall X P F, fine X P F -> finer X P F P F.
Proof. intros. split; auto. Qed.
Lemma finer_trans : forall X P F P' F' P'' F'', finer X P F P' F' -> finer X P' F' P'' F'' -> finer X P F P'' F''.
Proof. intros X P F P' F' P'' F'' (_ & A & B) (C & D & E). split; [|split]; auto. Qed.

Lemma fine_peel : forall X P F x, fine X P F -> row_ok x -> sat X (id x) = false -> finer X P F (diff P (self x)) F.
Proof.
  intros X P F x [A B] O U. split; [split|split]; auto; intros v.
  - intros V s. rewrite mem_diff, (A v V s). simpl. apply negb_true_iff. destruct (mem (self x) v) eqn:M; [|reflexivity].
    apply (ok_self x O) in M. subst. congruence.
  - rewrite mem_diff. intros M. apply andb_true_iff in M. tauto.
Qed.

Lemma fine_force : forall X a t x, stands X a -> spend X a <= t -> row_ok x -> mem (sT a) (id x) = true ->
  let D := sure a in let L := loose a in
  let extra := count 0 (hear x) L in
  count 0 (hear x) D + smaller extra t = need x ->
  forall v, mem (inter (hear x) (if extra <=? t then union D L else D)) v = true -> X v = true.
Proof.
  intros X a t x ST B O T D L extra E v M. rewrite mem_inter, (ok_hear x O) in M. apply andb_true_iff in M. destruct M as [H M].
  pose proof (inside_parts X a (sP a) t (id x) ST (on_P X a ST) B) as (E1 & A1 & A2 & A3).
  fold (sure a) in E1, A1, A2, A3. fold (loose a) in A2. fold L in A2. fold D in E1, A1, A2, A3.
  destruct (on_T X a ST _ T) as [_ SA]. unfold sat in SA. apply Nat.leb_le in SA. rewrite <- (ok_need x O) in SA.
  unfold extra in E, M. clear extra. rewrite !count_hear in E by assumption. rewrite count_hear in M by assumption.
  rewrite smaller_min in E.
  assert (V : In v all) by (apply in_seq; apply h_range in H; lia).
  destruct (X v) eqn:XV; [reflexivity|exfalso].
  destruct (mem D v) eqn:DV.
  - assert (cnt all (fun v => h (id x) v && X v && mem D v) < cnt all (fun v => h (id x) v && mem D v)); [|lia].
    apply cnt_lt with v; auto; [|rewrite H, DV; reflexivity|rewrite XV, andb_false_r; reflexivity].
    intros u _ Q. repeat (apply andb_true_iff in Q; destruct Q as [Q ?]). apply andb_true_iff; auto.
  - destruct (Nat.leb_spec (cnt all (fun v => h (id x) v && mem L v)) t); [|congruence].
    rewrite mem_union, DV in M. simpl in M.
    assert (cnt all (fun v => h (id x) v && X v && negb (mem D v)) < cnt all (fun v => h (id x) v && mem L v)); [|lia].
    apply cnt_lt with v; auto; [|rewrite H, M; reflexivity|rewrite XV, andb_false_r; reflexivity].
    intros u _ Q. repeat (apply andb_true_iff in Q; destruct Q as [Q ?]). unfold L, loose. fold D.
    rewrite Q, mem_diff, (on_C X a ST u H2), H1. reflexivity.
Qed.

Lemma look_word_sound : forall X a t, stands X a -> spend X a <= t -> forall rows w P F,
  Forall row_ok rows -> fine X P F ->
  match look_word rows w (sure a) (loose a) t (sT a) P F with
  | Some (P', F') => finer X P F P' F' | None => False end.
Proof.
  intros X a t ST B rows w. induction rows as [|x rest IH]; intros P F O FI; [apply finer_refl; assumption|].
  inversion O as [|? ? OX OR]; subst. cbn [look_word].
  destruct (w_is0 (w_and w (bit x))); [apply IH; assumption|].
  destruct (need x <? count 0 (hear x) (sure a)); [apply IH; assumption|].
  pose proof (inside_reach X a (sP a) t x ST (on_P X a ST) B OX) as R. cbv zeta in R.
  fold (sure a) in R. fold (loose a) in R.
  destruct (Nat.ltb_spec (count 0 (hear x) (sure a) + smaller (count 0 (hear x) (loose a)) t) (need x)) as [U|U].
  - pose proof (unsat X x _ OX R U) as NS. destruct (mem (sT a) (id x)) eqn:T.
    + destruct (on_T X a ST _ T). congruence.
    + pose proof (fine_peel X P F x FI OX NS) as FP.
      specialize (IH (diff P (self x)) F OR (proj1 FP)). destruct (look_word rest w _ _ t _ _ F) as [[P' F']|]; [|assumption].
      apply finer_trans with (1 := FP). assumption.
  - destruct ((_ =? need x) && mem (sT a) (id x)) eqn:Q; [|apply IH; assumption].
    apply andb_true_iff in Q. destruct Q as [Q T]. apply Nat.eqb_eq in Q.
    pose proof (fine_force X a t x ST B OX T Q) as FF. cbv zeta in FF.
    set (N := inter _ _) in *.
    assert (FP : finer X P F P (union F N)).
    { destruct FI as [FA FB]. split; [split|split]; auto; intros v; rewrite mem_union; intros M.
      - apply orb_true_iff in M. destruct M; auto.
      - rewrite M. reflexivity. }
    specialize (IH P (union F N) OR (proj1 FP)). destruct (look_word rest w _ _ t _ P _) as [[P' F']|]; [|assumption].
    apply finer_trans with (1 := FP). assumption.
Qed.

Lemma look_sound : forall X a t, stands X a -> spend X a <= t -> forall groups nodes P F,
  Forall (Forall row_ok) groups -> fine X P F ->
  match look groups nodes (sure a) (loose a) t (sT a) P F with
  | Some (P', F') => finer X P F P' F' | None => False end.
Proof.
  intros X a t ST B groups. induction groups as [|rows groups IH]; intros nodes P F O FI; [apply finer_refl; assumption|].
  inversion O as [|? ? OX OR]; subst. destruct nodes as [|w nodes]; [apply finer_refl; assumption|]. cbn [look].
  destruct (w_is0 w); [apply IH; assumption|].
  pose proof (look_word_sound X a t ST B rows w P F OX FI) as W.
  destruct (look_word rows w _ _ t _ P F) as [[P' F']|]; [|contradiction].
  specialize (IH nodes P' F' OR (proj1 W)). destruct (look groups nodes _ _ t _ P' F') as [[P'' F'']|]; [|assumption].
  apply finer_trans with (1 := W). assumption.
Qed.

(* *share* *)
Lemma keep_word_sound : forall X a t Q0, stands X a -> spend X a <= t ->
  (forall v, X v = true -> sat X v = true -> mem Q0 v = true) ->
  let D := union Q0 (sF a) in
  forall rows w Q, Forall row_ok rows -> (forall v, X v = true -> sat X v = true -> mem Q v = true) ->
  forall v, X v = true -> sat X v = true -> mem (keep_word rows w D (diff (sC a) D) t Q) v = true.
Proof.
  intros X a t Q0 ST B HQ D rows w. induction rows as [|x rest IH]; intros Q O H; [assumption|].
  inversion O as [|? ? OX OR]; subst. cbn [keep_word].
  destruct (w_is0 (w_and w (bit x))); [apply IH; assumption|].
  destruct (need x <=? count 0 (hear x) D); [apply IH; assumption|].
  destruct (Nat.ltb_spec (count 0 (hear x) D + smaller (count 0 (hear x) (diff (sC a) D)) t) (need x)) as [U|U];
    [|apply IH; assumption].
  pose proof (unsat X x _ OX (inside_reach X a Q0 t x ST HQ B OX) U) as NS. apply IH; [assumption|].
  intros v V s. rewrite mem_diff, (H v V s). simpl. apply negb_true_iff. destruct (mem (self x) v) eqn:M; [|reflexivity].
  apply (ok_self x OX) in M. subst. congruence.
Qed.

Lemma keep_sound : forall X a t Q0, stands X a -> spend X a <= t ->
  (forall v, X v = true -> sat X v = true -> mem Q0 v = true) ->
  let D := union Q0 (sF a) in
  forall groups nodes Q, Forall (Forall row_ok) groups -> (forall v, X v = true -> sat X v = true -> mem Q v = true) ->
  forall v, X v = true -> sat X v = true -> mem (keep groups nodes D (diff (sC a) D) t Q) v = true.
Proof.
  intros X a t Q0 ST B HQ D groups. induction groups as [|rows groups IH]; intros nodes Q O H; [assumption|].
  inversion O as [|? ? OX OR]; subst. destruct nodes as [|w nodes]; [assumption|]. cbn [keep]. apply IH; [assumption|].
  destruct (w_is0 w); [assumption|]. apply keep_word_sound; assumption.
Qed.

Lemma suffices_sound : forall X a t, stands X a -> (exists v, X v = true /\ sat X v = true) -> spend X a <= t ->
  forall groups, Forall (Forall row_ok) groups -> forall fuel Q nodes,
  (forall v, X v = true -> sat X v = true -> mem Q v = true) -> suffices fuel groups a t Q nodes = true.
Proof.
  intros X a t ST SX B groups O fuel. induction fuel as [|fuel IH]; intros Q nodes H; [reflexivity|]. cbn [suffices].
  destruct (isempty Q || negb (subset (sT a) Q)) eqn:E.
  - exfalso. apply orb_true_iff in E. destruct E as [E|E].
    + destruct SX as (v & V & s). pose proof (H v V s) as M. rewrite (isempty_mem Q v E) in M. discriminate.
    + apply negb_true_iff in E. rewrite subset_true in E; [discriminate|].
      intros v M. destruct (on_T X a ST v M). auto.
  - cbv zeta. set (Q' := keep _ _ _ _ _ _). destruct (equal Q' Q); [reflexivity|]. apply IH.
    intros v V s. apply keep_sound with (X := X); assumption.
Qed.

Lemma least_sound : forall enough m, (forall t, m <= t -> enough t = true) -> forall fuel low high, low <= m -> least fuel enough low high <= m.
Proof.
  intros enough m H fuel. induction fuel as [|fuel IH]; intros low high L; [assumption|]. cbn [least].
  destruct (low <? high); [|assumption]. destruct (enough ((low + high) / 2)) eqn:E; apply IH; [assumption|].
  destruct (le_lt_dec m ((low + high) / 2)) as [Q|Q]; [rewrite (H _ Q) in E; discriminate|]. lia.
Qed.

Lemma least_exempt_sound : forall X a, stands X a -> (exists v, X v = true /\ sat X v = true) ->
  forall groups, Forall (Forall row_ok) groups -> forall fuel left, least_exempt fuel groups a left <= spend X a.
Proof.
  intros X a ST SX groups O fuel left. unfold least_exempt.
  assert (H : forall t, spend X a <= t -> suffices fuel groups a t (sP a) (sP a) = true)
    by (intros; apply suffices_sound with (X := X); auto; apply (on_P X a ST)).
  destruct (suffices fuel groups a 0 (sP a) (sP a)) eqn:E; [lia|]. apply least_sound; [assumption|].
  destruct (spend X a) eqn:Z; [|lia]. rewrite H in E; [discriminate|lia].
Qed.

(* *spent* *)
Lemma spent_sound : forall X a t, (forall v, X v = true -> v < n) -> stands X a -> spend X a <= t -> stands X (spent a t) /\ spend X (spent a t) = spend X a.
Proof.
  intros X a t XR ST B. unfold spent. destruct (Nat.eqb_spec t 0) as [->|]; [|auto]. split; [|reflexivity].
  assert (Z : forall v, X v = true -> further X (sP a) (sF a) v = false).
  { intros v V. destruct (further X (sP a) (sF a) v) eqn:E; [exfalso|reflexivity]. unfold spend in B.
    assert (1 <= cnt all (further X (sP a) (sF a))); [|lia]. apply cnt_pos with v; [|assumption].
    apply in_seq. apply XR in V. lia. }
  split; simpl.
  - intros v V. unfold sure. rewrite mem_union. apply Z in V as W. unfold further, exempt in W. rewrite V in W. simpl in W.
    destruct (sat X v) eqn:s; [rewrite (on_P X a ST v V s); reflexivity|]. simpl in W.
    destruct (mem (sF a) v); [apply orb_true_r|discriminate].
  - apply (on_P X a ST).
  - apply (on_F X a ST).
  - intros v M. rewrite mem_inter in M. apply andb_true_iff in M. destruct M as [P F]. pose proof (on_F X a ST v F) as V.
    split; [assumption|]. apply Z in V as W. unfold further, exempt in W. rewrite V, F, P in W. simpl in W.
    destruct (sat X v); [reflexivity|discriminate].
Qed.
(* *member* *)
Lemma take_T_sound : forall X a, stands X a -> stands X (take_T a) /\ spend X (take_T a) <= spend X a.
Proof.
  intros X a ST. split.
  - split; try apply ST. simpl. intros v M. rewrite mem_union in M. apply orb_true_iff in M.
    destruct M as [M|M]; [apply (on_F X a ST v M)|apply (on_T X a ST v M)].
  - apply further_less; [auto|]. simpl. intros v M. rewrite mem_union, M. reflexivity.
Qed.

Lemma member_sound : forall X a F', stands X a -> (exists v, X v = true /\ sat X v = true) ->
  (forall v, mem F' v = true -> X v = true -> False) ->
  match member a F' with Some a' => stands X a' /\ spend X a' <= spend X a | None => False end.
Proof.
  intros X a F' ST (u & U & SU) HF. unfold member. cbv zeta.
  assert (HC : forall v, X v = true -> mem (diff (sC a) F') v = true).
  { intros v V. rewrite mem_diff, (on_C X a ST v V). simpl. apply negb_true_iff.
    destruct (mem F' v) eqn:M; [exfalso; eauto|reflexivity]. }
  assert (HP : forall v, X v = true -> sat X v = true -> mem (inter (sP a) (diff (sC a) F')) v = true).
  { intros v V s. rewrite mem_inter, (on_P X a ST v V s), (HC v V). reflexivity. }
  destruct (_ && negb _) eqn:E.
  - split; [split|]; simpl; auto; [apply (on_F X a ST)|apply (on_T X a ST)|]. apply further_less; [|auto].
    simpl. intros v M. rewrite mem_inter in M. apply andb_true_iff in M. tauto.
  - rewrite !subset_true in E; simpl in E.
    + apply negb_false_iff in E. pose proof (isempty_mem _ u E) as M. rewrite HP in M by assumption. discriminate.
    + intros v M. destruct (on_T X a ST v M). auto.
    + intros v M. pose proof (on_F X a ST v M). auto.
Qed.

Lemma known_sound : forall X a full, (forall v, X v = true -> v < n) -> stands X a ->
  (forall v, mem full v = (v <? n)) -> spend X a + count 0 full (known a) <= cnt all (exempt X).
Proof.
  intros X a full XR ST HF. rewrite (count_spec full (known a) 0 (size * length full + n)) by lia. simpl.
  rewrite (cnt_seq_cut n); [|lia|intros v V; rewrite HF; destruct (Nat.ltb_spec v n); [lia|reflexivity]].
  rewrite (cnt_split all (exempt X) (fun v => mem (sF a) v && negb (mem (sP a) v))).
  unfold spend, further. rewrite Nat.add_comm. apply Nat.add_le_mono_r. apply cnt_le. intros v _ M.
  apply andb_true_iff in M. destruct M as [_ M]. unfold known in M. rewrite mem_diff in M. rewrite M, andb_true_r.
  apply andb_true_iff in M. destruct M as [F P]. pose proof (on_F X a ST v F) as V. unfold exempt. rewrite V. simpl.
  destruct (sat X v) eqn:s; [rewrite (on_P X a ST v V s) in P; discriminate|reflexivity].
Qed.

(* *count* *)
Fixpoint served (blockers : list row) (v : nat) : nat :=
  match blockers with [] => 0 | y :: rest => Nat.b2n (h (id y) v) + served rest v end.

Lemma served_most : forall I v, served I v <= length I.
Proof. induction I as [|y I IH]; intros v; simpl; [lia|]. specialize (IH v). destruct (h (id y) v); simpl; lia. Qed.

Lemma heard_total_sum : forall I D, Forall row_ok I -> heard_total I D = sum all (fun v => Nat.b2n (mem D v) * served I v).
Proof.
  induction I as [|y I IH]; intros D O; [symmetry; apply sum_zero; intros; simpl; lia|].
  inversion O; subst. cbn [heard_total]. rewrite IH, count_hear, cnt_sum, <- sum_add by assumption.
  clear. induction all as [|v l IH]; simpl; [reflexivity|]. rewrite IH. f_equal. destruct (h (id y) v), (mem D v); simpl; lia.
Qed.

Lemma need_total_sum : forall Y b I, stands Y b -> Forall row_ok I -> Forall (fun y => mem (sT b) (id y) = true) I ->
  need_total I <= sum all (fun v => Nat.b2n (Y v) * served I v).
Proof.
  intros Y b I ST. induction I as [|y I IH]; intros O T; [simpl; lia|]. inversion O; inversion T; subst. cbn [need_total].
  destruct (on_T Y b ST (id y)) as [_ s]; [assumption|]. unfold sat in s. apply Nat.leb_le in s. rewrite <- (ok_need y) in s by assumption.
  unfold inside in s. rewrite cnt_sum in s.
  apply Nat.le_trans with (sum all (fun v => Nat.b2n (h (id y) v && Y v)) + sum all (fun v => Nat.b2n (Y v) * served I v)).
  - specialize (IH H2 H6). lia.
  - rewrite <- sum_add. apply sum_le. intros v _. simpl. destruct (h (id y) v), (Y v); simpl; lia.
Qed.

Lemma heard_any_mem : forall I D own v, Forall row_ok I ->
  mem (heard_any I D own) v = mem own v && negb (mem D v && (1 <=? served I v)).
Proof.
  induction I as [|y I IH]; intros D own v O; [simpl; rewrite andb_false_r, andb_true_r; reflexivity|].
  inversion O; subst. cbn [heard_any served]. rewrite IH, mem_diff, mem_inter, (ok_hear y) by assumption.
  destruct (mem own v), (mem D v), (h (id y) v); simpl; rewrite ?andb_false_r; reflexivity.
Qed.

Lemma excludes_sound : forall X Y a b left la lb x I, violating X Y -> stands X a -> stands Y b -> bounded X Y a b left la lb ->
  row_ok x -> Forall row_ok I -> Forall (fun y => mem (sT b) (id y) = true) I -> I <> [] ->
  excludes a b left lb x I = true -> X (id x) = true -> sat X (id x) = true -> False.
Proof.
  intros X Y a b left la lb x I V SX SY (B & BA & BB) OX OI T NE E XJ S. unfold excludes in E. apply Nat.ltb_lt in E.
  pose proof (need_total_sum Y b I SY OI T) as N1.
  assert (N2 : need x <= cnt all (fun v => h (id x) v && X v))
    by (rewrite (ok_need x OX); apply Nat.leb_le; exact S).
  rewrite heard_total_sum, count_hear in E by assumption. set (D := diff (sure b) (self x)) in *.
  set (own := heard_any I (sure b) (sure a)) in *.
  assert (sum all (fun v => Nat.b2n (Y v) * served I v) + cnt all (fun v => h (id x) v && X v) <=
          sum all (fun v => Nat.b2n (mem D v) * served I v) + cnt all (fun v => h (id x) v && mem own v)
          + spend X a + length I * spend Y b) as M.
  { unfold spend. rewrite !cnt_sum, <- sum_scale, <- !sum_add. apply sum_le. intros v _.
    pose proof (served_most I v) as SM. unfold D, own. rewrite mem_diff, heard_any_mem by assumption.
    unfold sure at 1 2. rewrite !mem_union. unfold further, exempt.
    destruct (Nat.eq_dec v (id x)) as [->|NJ].
    - rewrite h_loop. destruct (Y (id x)) eqn:YJ; [exfalso; exact (apart X Y V _ XJ YJ)|]. simpl. lia.
    - replace (mem (self x) v) with false
        by (symmetry; apply not_true_is_false; intros Q; apply (ok_self x OX) in Q; contradiction).
      destruct (Y v) eqn:YV.
      + destruct (X v) eqn:XV; [exfalso; exact (apart X Y V v XV YV)|]. rewrite andb_false_r. simpl.
        destruct (sat Y v) eqn:s; [rewrite (on_P Y b SY v YV s); simpl; lia|].
        destruct (mem (sP b) v); simpl; [lia|]. destruct (mem (sF b) v); simpl; lia.
      + simpl. destruct (X v) eqn:XV; simpl; [|rewrite andb_false_r; simpl; lia]. rewrite andb_true_r.
        destruct (h (id x) v); simpl; [|lia]. unfold sure. rewrite mem_union.
        destruct (mem (sP b) v || mem (sF b) v); simpl.
        * destruct (served I v); simpl; [|lia]. rewrite andb_true_r.
          destruct (sat X v) eqn:s; [rewrite (on_P X a SX v XV s); simpl; lia|].
          destruct (mem (sP a) v), (mem (sF a) v); simpl; lia.
        * rewrite andb_true_r. destruct (sat X v) eqn:s; [rewrite (on_P X a SX v XV s); simpl; lia|].
          destruct (mem (sP a) v), (mem (sF a) v); simpl; lia. }
  destruct I as [|y I]; [contradiction|]. cbn [length] in *. rewrite Nat.sub_succ, Nat.sub_0_r in E.
  assert (length I * spend Y b <= length I * lb) by (apply Nat.mul_le_mono_l; assumption). lia.
Qed.
End Question.
