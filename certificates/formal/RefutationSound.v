(* A graph with an accepted refutation has no violating pair. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Bytes Sets Rules Soundness Refutation.
Import ListNotations.

Section Question.
Variable n : nat.
Variable h : nat -> nat -> bool.
Variable needs : nat -> nat.
Variable q : question.
Hypothesis h_range : forall i v, h i v = true -> v < n.
Hypothesis h_loop : forall i, h i i = false.
Hypothesis groups_ok : Forall (Forall (row_ok n h needs)) (groups q).
Hypothesis row_of_ok : forall v x, row_of q v = Some x -> row_ok n h needs x.
Hypothesis full_ok : forall v, mem (full q) v = (v <? n).

Notation violating := (violating n h needs (spare q)).
Notation stands := (stands n h needs).
Notation spend := (spend n h needs).
Notation bounded := (bounded n h needs).
Notation sat := (sat n h needs).

Lemma pass_sound : forall X a t last, stands X a -> spend X a <= t ->
  match pass q a t last with Some a' => stands X a' /\ spend X a' <= spend X a | None => False end.
Proof.
  intros X a t last ST B. unfold pass.
  pose proof (look_sound n h needs h_range X a t ST B (groups q) (worth q a t last) (sP a) (sF a) groups_ok
                (conj (on_P _ _ _ _ _ ST) (on_F _ _ _ _ _ ST))) as L.
  destruct (look _ _ _ _ _ _ _ _) as [[P F]|]; [|assumption]. destruct L as ((A1 & A2) & B1 & B2). split.
  - split; simpl; auto; apply ST.
  - apply further_less; assumption.
Qed.

Lemma settle_sound : forall X Y, violating X Y -> forall fuel a b la lb sa sb, stands X a -> stands Y b ->
  spend X a <= la -> spend Y b <= lb ->
  match settle fuel q a b la lb sa sb with
  | Contradiction => False
  | Stuck => True
  | Settled a' b' more la' lb' => stands X a' /\ stands Y b' /\ bounded X Y a' b' more la' lb'
  end.
Proof.
  intros X Y V fuel. induction fuel as [|fuel IH]; intros a b la lb sa sb SX SY BX BY; [exact I|]. cbn [settle]. cbv zeta.
  destruct V as [XR YR AP SATX SATY FEW] eqn:VE. clear VE.
  destruct (take_T_sound n h needs X a SX) as [SX0 BX0]. destruct (take_T_sound n h needs Y b SY) as [SY0 BY0].
  pose proof (member_sound n h needs X (take_T a) (sF (take_T b)) SX0 SATX) as MX.
  pose proof (member_sound n h needs Y (take_T b) (sF (take_T a)) SY0 SATY) as MY.
  specialize (MX (fun v M XV => AP v XV (on_F _ _ _ _ _ SY0 v M))).
  specialize (MY (fun v M YV => AP v (on_F _ _ _ _ _ SX0 v M) YV)).
  destruct (member (take_T a) _) as [a1|]; [|assumption]. destruct (member (take_T b) _) as [b1|]; [|assumption].
  destruct MX as [SX1 BX1]. destruct MY as [SY1 BY1].
  pose proof (known_sound n h needs X a1 (full q) XR SX1 full_ok) as KX.
  pose proof (known_sound n h needs Y b1 (full q) YR SY1 full_ok) as KY.
  set (gone := count 0 (full q) (known a1) + count 0 (full q) (known b1)) in *.
  destruct (Nat.ltb_spec (spare q) gone) as [G|G]; [unfold gone in G; lia|].
  set (left := spare q - gone) in *. assert (BL : spend X a1 + spend Y b1 <= left) by (unfold left, gone; lia).
  clearbody left. clear gone G KX KY.
  rewrite !smaller_min. assert (TA : spend X a1 <= Nat.min la left) by lia. assert (TB : spend Y b1 <= Nat.min lb left) by lia.
  destruct (spent_sound n h needs X a1 _ XR SX1 TA) as [SX2 BX2]. destruct (spent_sound n h needs Y b1 _ YR SY1 TB) as [SY2 BY2].
  set (a2 := spent a1 _) in *. set (b2 := spent b1 _) in *.
  assert (TA2 : spend X a2 <= Nat.min la left) by lia. assert (TB2 : spend Y b2 <= Nat.min lb left) by lia.
  pose proof (pass_sound X a2 _ sa SX2 TA2) as PX. pose proof (pass_sound Y b2 _ sb SY2 TB2) as PY.
  destruct (pass q a2 _ sa) as [a3|]; [|assumption]. destruct (pass q b2 _ sb) as [b3|]; [|assumption].
  destruct PX as [SX3 BX3]. destruct PY as [SY3 BY3].
  destruct (negb _); [apply IH; try assumption; lia|].
  destruct (left =? 0); [split; [|split]; try assumption; unfold Soundness.bounded; lia|].
  pose proof (least_exempt_sound n h needs h_range X a3 SX3 SATX (groups q) groups_ok (rounds q) left) as LX.
  pose proof (least_exempt_sound n h needs h_range Y b3 SY3 SATY (groups q) groups_ok (rounds q) left) as LY.
  destruct (_ || _); [|split; [|split]; try assumption; unfold Soundness.bounded; lia].
  rewrite !smaller_min. apply IH; try assumption; lia.
Qed.

Lemma node_ok : forall body pos x pos', node q body pos = Some (x, pos') -> row_ok n h needs x.
Proof.
  intros body pos x pos' N. unfold node in N. destruct (number _ _ _ _ _ _) as [[v p]|]; [|discriminate].
  destruct (row_of q v) as [y|] eqn:R; [|discriminate]. destruct (id y =? v); [|discriminate].
  injection N as <- <-. eauto.
Qed.

Lemma blocker_ok : forall body b pos y pos', blocker q body b pos = Some (y, pos') ->
  row_ok n h needs y /\ mem (sT b) (id y) = true.
Proof.
  intros body b pos y pos' B. unfold blocker in B. destruct (node q body pos) as [[z p]|] eqn:N; [|discriminate].
  destruct (mem (sT b) (id z)) eqn:M; [|discriminate]. injection B as <- <-. split; [eapply node_ok; eauto|assumption].
Qed.

(* Taking an unsatisfied node from P. *)
Lemma drop_P : forall X a x, stands X a -> row_ok n h needs x -> (X (id x) = true -> sat X (id x) = true -> False) ->
  mem (sT a) (id x) = false -> stands X (Side (sC a) (diff (sP a) (self x)) (sF a) (sT a)).
Proof.
  intros X a x ST O NS T. split; simpl; try apply ST. intros v V s. rewrite mem_diff, (on_P _ _ _ _ _ ST v V s). simpl.
  apply negb_true_iff. destruct (mem (self x) v) eqn:M; [|reflexivity]. apply (ok_self _ _ _ _ O) in M. subst. contradiction (NS V s).
Qed.

Lemma exclude_sound : forall X Y body pos a b left la lb two, violating X Y -> stands X a -> stands Y b ->
  bounded X Y a b left la lb ->
  match exclude q body pos a b left lb two with
  | Some (_, Some a') => stands X a' /\ spend X a' <= spend X a
  | Some (_, None) => False
  | None => True
  end.
Proof.
  intros X Y body pos a b left la lb two V SX SY B. unfold exclude.
  destruct (node q body pos) as [[x p1]|] eqn:N; [|exact I]. apply node_ok in N.
  destruct (blocker q body b p1) as [[y p2]|] eqn:BY; [|exact I]. apply blocker_ok in BY. destruct BY as [OY TY].
  destruct (if two then _ else _) as [[I e']|] eqn:W; [|exact Logic.I].
  assert (K : Forall (row_ok n h needs) I /\ Forall (fun y => mem (sT b) (id y) = true) I /\ I <> []).
  { destruct two; [|injection W as <- <-; (split; [|split; [|discriminate]]); auto].
    destruct (blocker q body b p2) as [[z p3]|] eqn:BZ; [|discriminate]. apply blocker_ok in BZ. destruct BZ as [OZ TZ].
    destruct (id y =? id z); [discriminate|]. injection W as <- <-. (split; [|split; [|discriminate]]); auto. }
  destruct K as (K1 & K2 & K3). destruct (mem (sP a) (id x)); [|exact Logic.I]. simpl.
  destruct (excludes a b left lb x I) eqn:E; [|exact Logic.I].
  pose proof (excludes_sound n h needs (spare q) h_range h_loop X Y a b left la lb x I V SX SY B N K1 K2 K3 E) as NS.
  destruct (mem (sT a) (id x)) eqn:T.
  - destruct (on_T _ _ _ _ _ SX _ T). auto.
  - split; [apply drop_P; assumption|]. apply further_less; [|auto]. simpl. intros v M. rewrite mem_diff in M.
    apply andb_true_iff in M. tauto.
Qed.

Lemma bounded_swap : forall X Y a b left la lb, bounded X Y a b left la lb -> bounded Y X b a left lb la.
Proof. unfold Soundness.bounded. intros. lia. Qed.

Lemma counts_sound : forall X Y, violating X Y -> forall body fuel pos a b left la lb run, stands X a -> stands Y b ->
  bounded X Y a b left la lb ->
  match counts fuel q body pos a b left la lb run with
  | Closed _ => False | Open _ a' b' => stands X a' /\ stands Y b' | Wrong _ => True end.
Proof.
  intros X Y V body fuel. induction fuel as [|fuel IH]; intros pos a b left la lb run SX SY B; [exact I|]. cbn [counts]. cbv zeta.
  destruct ((6 <=? next body pos) && (next body pos <? 10)).
  - destruct (next body pos mod 2 =? 0).
    + pose proof (exclude_sound X Y body (S pos) a b left la lb (8 <=? next body pos) V SX SY B) as E.
      destruct (exclude _ _ _ _ _ _ _ _) as [[p [a'|]]|]; [|contradiction|exact I]. destruct E as [E1 E2].
      apply IH; try assumption. unfold Soundness.bounded in *. lia.
    + pose proof (exclude_sound Y X body (S pos) b a left lb la (8 <=? next body pos) (violating_swap _ _ _ _ _ _ V) SY SX
                    (bounded_swap _ _ _ _ _ _ _ B)) as E.
      destruct (exclude _ _ _ _ _ _ _ _) as [[p [b'|]]|]; [|contradiction|exact I]. destruct E as [E1 E2].
      apply IH; try assumption. unfold Soundness.bounded in *. lia.
  - destruct run; [|auto]. destruct (next body pos =? 0); [|exact I].
    assert (XS : spend X a <= spare q /\ spend Y b <= spare q).
    { assert (L : forall Z c, spend Z c <= cnt (seq 0 n) (exempt n h needs Z))
        by (intros; apply cnt_le; intros v _ Q; apply andb_true_iff in Q; tauto).
      pose proof (L X a). pose proof (L Y b). pose proof (few _ _ _ _ _ _ V). lia. }
    pose proof (settle_sound X Y V (rounds q) a b (spare q) (spare q) None None SX SY (proj1 XS) (proj2 XS)) as ST.
    destruct (settle _ _ _ _ _ _ _ _) as [|a' b' left' la' lb'|]; [assumption| |exact I].
    destruct ST as (S1 & S2 & S3). apply IH; assumption.
Qed.

Definition none_in (st : state) : Prop := forall X Y, violating X Y -> stands X (fst st) -> stands Y (snd st) -> False.

Lemma satisfied_sound : forall X a x yes no, stands X a -> row_ok n h needs x -> satisfied_branch a x = Some (yes, no) ->
  (X (id x) = true /\ sat X (id x) = true -> stands X yes) /\
  ((X (id x) = true -> sat X (id x) = true -> False) -> stands X no).
Proof.
  intros X a x yes no ST O B. unfold satisfied_branch in B. destruct (mem (sP a) (id x)); [|discriminate]. simpl in B.
  destruct (mem (sT a) (id x)) eqn:T; [discriminate|]. injection B as <- <-. split.
  - intros [V s]. split; simpl; try apply ST. intros v M. rewrite mem_union in M. apply orb_true_iff in M.
    destruct M as [M|M]; [apply (on_T _ _ _ _ _ ST v M)|]. apply (ok_self _ _ _ _ O) in M. subst. auto.
  - intros NS. apply drop_P; assumption.
Qed.

Lemma member_branch_sound : forall X a x yes no, stands X a -> row_ok n h needs x -> member_branch a x = Some (yes, no) ->
  (X (id x) = true -> stands X yes) /\ (X (id x) = false -> stands X no).
Proof.
  intros X a x yes no ST O B. unfold member_branch in B. destruct (mem (sC a) (id x)); [|discriminate]. simpl in B.
  destruct (mem (sF a) (id x)) eqn:T; [discriminate|]. injection B as <- <-. split.
  - intros V. split; simpl; try apply ST. intros v M. rewrite mem_union in M. apply orb_true_iff in M.
    destruct M as [M|M]; [apply (on_F _ _ _ _ _ ST v M)|]. apply (ok_self _ _ _ _ O) in M. subst. auto.
  - intros V. assert (NV : forall v, X v = true -> mem (self x) v = false).
    { intros v W. destruct (mem (self x) v) eqn:M; [|reflexivity]. apply (ok_self _ _ _ _ O) in M. subst. congruence. }
    split; simpl; try apply ST; intros v W; intros; rewrite mem_diff, (NV v W), andb_true_r;
      [apply (on_C _ _ _ _ _ ST)|apply (on_P _ _ _ _ _ ST)]; assumption.
Qed.

Lemma equal_sides_eq : forall a b, equal_sides a b = true -> a = b.
Proof.
  intros [] [] E. unfold equal_sides in E. simpl in E. repeat (apply andb_true_iff in E; destruct E as [E ?]).
  f_equal; apply equal_eq; assumption.
Qed.

Lemma branch_sound : forall op a b x symmetric yes no, row_ok n h needs x -> branch op a b x symmetric = Some (yes, no) ->
  none_in yes -> none_in no -> none_in (a, b).
Proof.
  intros op a b x symmetric yes no O B HY HN X Y V SX SY. cbn [fst snd] in SX, SY.
  assert (DS : forall Z, (Z (id x) = true /\ sat Z (id x) = true) \/ (Z (id x) = true -> sat Z (id x) = true -> False)).
  { intros Z. destruct (Z (id x)), (sat Z (id x)); auto; right; discriminate. }
  destruct op as [|[|[|[|[|[|op]]]]]]; cbn [branch] in B; try discriminate.
  - destruct symmetric; [|discriminate]. destruct (equal_sides a b) eqn:E; [|discriminate]. simpl in B.
    apply equal_sides_eq in E. subst b. destruct (satisfied_branch a x) as [[y z]|] eqn:SB; [|discriminate].
    injection B as <- <-. destruct (satisfied_sound X a x y z SX O SB) as [X1 X2].
    destruct (satisfied_sound Y a x y z SY O SB) as [Y1 Y2].
    destruct (DS X) as [D|D]; [apply (HY X Y V); auto|]. destruct (DS Y) as [D'|D'].
    + apply (HY Y X (violating_swap _ _ _ _ _ _ V)); auto.
    + apply (HN X Y V); auto.
  - destruct (satisfied_branch a x) as [[y z]|] eqn:SB; [|discriminate]. injection B as <- <-.
    destruct (satisfied_sound X a x y z SX O SB) as [X1 X2]. destruct (DS X); [apply (HY X Y V)|apply (HN X Y V)]; auto.
  - destruct (satisfied_branch b x) as [[y z]|] eqn:SB; [|discriminate]. injection B as <- <-.
    destruct (satisfied_sound Y b x y z SY O SB) as [X1 X2]. destruct (DS Y); [apply (HY X Y V)|apply (HN X Y V)]; auto.
  - destruct (member_branch a x) as [[y z]|] eqn:SB; [|discriminate]. injection B as <- <-.
    destruct (member_branch_sound X a x y z SX O SB) as [X1 X2]. destruct (X (id x)) eqn:D; [apply (HY X Y V)|apply (HN X Y V)]; auto.
  - destruct (member_branch b x) as [[y z]|] eqn:SB; [|discriminate]. injection B as <- <-.
    destruct (member_branch_sound Y b x y z SY O SB) as [X1 X2]. destruct (Y (id x)) eqn:D; [apply (HY X Y V)|apply (HN X Y V)]; auto.
Qed.

Lemma walk_sound : forall body fuel pos a b symmetric waiting, walk fuel q body pos a b symmetric waiting = Refuted ->
  none_in (a, b) /\ Forall (fun w => none_in (fst w)) waiting.
Proof.
  intros body fuel. induction fuel as [|fuel IH]; intros pos a b symmetric waiting W; [discriminate|]. cbn [walk] in W. cbv zeta in W.
  assert (CL : forall pos', match waiting with
      | [] => if pos' =? len body then Refuted else Refused pos'
      | ((a', b'), symmetric') :: rest => walk fuel q body pos' a' b' symmetric' rest end = Refuted ->
      Forall (fun w => none_in (fst w)) waiting).
  { intros pos' Q. destruct waiting as [|[[a' b'] s'] rest]; [constructor|]. apply IH in Q. constructor; tauto. }
  assert (XS : forall X Y c d, violating X Y -> spend X c <= spare q /\ spend Y d <= spare q).
  { intros X Y c d V. assert (L : forall Z e, spend Z e <= cnt (seq 0 n) (exempt n h needs Z))
        by (intros; apply cnt_le; intros v _ Q; apply andb_true_iff in Q; tauto).
      pose proof (L X c). pose proof (L Y d). pose proof (few _ _ _ _ _ _ V). lia. }
  assert (SS : forall X Y, violating X Y -> stands X a -> stands Y b ->
    match settle (rounds q) q a b (spare q) (spare q) None None with
    | Contradiction => False | Stuck => True
    | Settled a' b' more la' lb' => stands X a' /\ stands Y b' /\ bounded X Y a' b' more la' lb' end).
  { intros X Y V SX SY. apply settle_sound; auto; apply (XS X Y a b V). }
  destruct (settle _ _ _ _ _ _ _ _) as [|a1 b1 left la lb|]; [| |discriminate].
  { split; [|eauto]. intros X Y V SX SY. exact (SS X Y V SX SY). }
  assert (CS : forall X Y, violating X Y -> stands X a -> stands Y b ->
    match counts (S (len body)) q body pos a1 b1 left la lb false with
    | Closed _ => False | Open _ a' b' => stands X a' /\ stands Y b' | Wrong _ => True end).
  { intros X Y V SX SY. destruct (SS X Y V SX SY) as (S1 & S2 & S3). apply counts_sound; assumption. }
  destruct (counts _ _ _ _ _ _ _ _ _ _) as [p|p a2 b2|p]; [| |discriminate].
  { split; [|eauto]. intros X Y V SX SY. exact (CS X Y V SX SY). }
  destruct (node q body (S p)) as [[x p2]|] eqn:N; [|discriminate]. apply node_ok in N.
  destruct (branch _ a2 b2 x symmetric) as [[[a3 b3] no]|] eqn:B; [|discriminate].
  apply IH in W. destruct W as [W1 W2]. inversion W2 as [|? ? W3 W4]; subst. simpl in W3. split; [|assumption].
  intros X Y V SX SY. destruct (CS X Y V SX SY) as [S1 S2].
  exact (branch_sound _ _ _ _ _ _ _ N B W1 W3 X Y V S1 S2).
Qed.

Theorem refutes_sound : forall body, refutes q body = Refuted -> forall X Y, violating X Y -> False.
Proof.
  intros body R X Y V. unfold refutes in R. apply walk_sound in R. destruct R as [R _]. apply (R X Y V); simpl.
  - split; simpl; try discriminate; intros v W; intros; rewrite full_ok; apply Nat.ltb_lt; apply (in_X _ _ _ _ _ _ V v W).
  - split; simpl; try discriminate; intros v W; intros; rewrite full_ok; apply Nat.ltb_lt; apply (in_Y _ _ _ _ _ _ V v W).
Qed.
End Question.
