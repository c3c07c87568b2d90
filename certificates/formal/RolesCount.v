(* *share* and *count*: how many wants the further malicious nodes serve at most. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Sets Tables Rules Soundness Refutation Roles RolesSound.
Import ListNotations.

Lemma tally_more : forall A (p : A -> bool) l k, tally p l k = k + tally p l 0.
Proof.
  intros A p l. induction l as [|o l IH]; intros k; simpl; [lia|]. rewrite IH, (IH (if p o then 1 else 0)). destruct (p o); lia.
Qed.
Lemma tally_most : forall A (p : A -> bool) l, tally p l 0 <= tally (fun _ => true) l 0.
Proof.
  intros A p l. induction l as [|o l IH]; cbn [tally]; [lia|]. rewrite tally_more, (tally_more _ (fun _ => true)).
  destruct (p o); lia.
Qed.

Section Threat.
Variable n : nat.
Variable h : nat -> nat -> bool.
Variable needs : nat -> nat.
Variable t : threat.
Hypothesis OK : sound_threat n h needs t.

Notation all := (seq 0 n).
Notation two := (two_faces t).
Notation f := (most t).
Notation row_ok := (row_ok n h needs).
Notation solution := (RolesSound.solution n h needs t).
Notation solution_swap := (RolesSound.solution_swap n h needs t).
Notation not_both := (RolesSound.not_both n h needs t).
Notation clean_1 := (RolesSound.clean_1 n h needs t).
Notation clean_2 := (RolesSound.clean_2 n h needs t).
Notation of_faces := (RolesSound.of_faces n h needs t).
Notation held_1 := (RolesSound.held_1 n h needs t).
Notation held_2 := (RolesSound.held_2 n h needs t).
Notation few_more := (RolesSound.few_more n h needs t).
Notation size_is := (RolesSound.size_is n h needs t OK).
Notation held_parts := (RolesSound.held_parts n h needs t OK).
Notation left_enough := (RolesSound.left_enough n h needs t OK).

(* *share* *)
Definition open_sum (open : list bits) (X : nat -> bool) : nat := fold_right (fun o k => cnt all (fun v => mem o v && X v) + k) 0 open.

Lemma wants_word_sound : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> forall rows w wanted open,
  Forall row_ok rows ->
  let X := more_bad M1 M2 (bad s) in
  wanted <= open_sum open X ->
  let (wanted', open') := wants_word rows w (pT (here s)) (sure_of (here s) (bad s)) (loose_of (here s) (bad s)) wanted open in
  wanted' <= open_sum open' X.
Proof.
  intros N1 N2 M1 M2 s S ST rows w. induction rows as [|x rest IH]; intros wanted open O X LE; [assumption|].
  inversion O as [|? ? OX OR]; subst. cbn [wants_word]. cbv zeta.
  destruct (w_is0 (w_and w (bit x))); [apply IH; assumption|].
  destruct (_ && mem (pT (here s)) (id x)) eqn:E; [|apply IH; assumption]. apply andb_true_iff in E. destruct E as [_ TX].
  apply (on_T _ _ _ (on_here _ _ _ _ _ ST)) in TX. apply IH; [assumption|].
  destruct (held_parts _ _ _ _ _ _ S ST OX TX) as (P1 & P2 & _). cbv zeta in P1, P2. fold X.
  set (D := sure_of (here s) (bad s)) in *. set (L := loose_of (here s) (bad s)) in *.
  cbn [open_sum fold_right]. fold (open_sum open X).
  assert (CL : cnt all (fun v => h (id x) v && (N1 v || M1 v) && negb (mem D v)) <= cnt all (fun v => mem (inter (hear x) L) v && X v)).
  { apply cnt_le. intros v _ V. apply andb_true_iff in V. destruct V as [V ND]. apply andb_true_iff in V. destruct V as [HV V].
    apply negb_true_iff in ND. destruct (not_sure _ _ _ _ _ v ST V ND) as (Q1 & Q2 & _).
    rewrite mem_inter, (ok_hear _ _ _ _ OX), HV. fold L in Q1. unfold X. rewrite Q1, Q2. reflexivity. }
  lia.
Qed.
Lemma wants_sound : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> forall groups nodes wanted open,
  Forall (Forall row_ok) groups ->
  let X := more_bad M1 M2 (bad s) in
  wanted <= open_sum open X ->
  let (wanted', open') := wants groups nodes (pT (here s)) (sure_of (here s) (bad s)) (loose_of (here s) (bad s)) wanted open in
  wanted' <= open_sum open' X.
Proof.
  intros N1 N2 M1 M2 s S ST groups. induction groups as [|rows groups IH]; intros nodes wanted open O X LE; [assumption|].
  inversion O as [|? ? OX OR]; subst. destruct nodes as [|w nodes]; [assumption|]. cbn [wants].
  destruct (w_is0 w); [apply IH; assumption|].
  pose proof (wants_word_sound _ _ _ _ _ S ST rows w wanted open OX LE) as W. destruct (wants_word _ _ _ _ _ _ _). apply IH; assumption.
Qed.

Lemma open_sum_ext : forall open X Y, (forall v, X v = Y v) -> open_sum open X = open_sum open Y.
Proof.
  intros open X Y E. induction open as [|o open IH]; [reflexivity|]. cbn [open_sum fold_right]. unfold open_sum in IH. rewrite IH.
  f_equal. apply cnt_ext. intros v _. rewrite E. reflexivity.
Qed.

Lemma open_sum_votes : forall open X, open_sum open X = sum all (fun v => Nat.b2n (X v) * tally (fun o => mem o v) open 0).
Proof.
  intros open X. induction open as [|o open IH]; cbn [open_sum fold_right tally]; [symmetry; apply sum_zero; intros; lia|].
  unfold open_sum in IH. rewrite IH, cnt_sum, <- sum_add.
  assert (E : forall l (p q : nat -> nat), (forall v, p v = q v) -> sum l p = sum l q)
    by (intros l p q Q; induction l as [|v l IH']; simpl; [reflexivity|rewrite Q, IH'; reflexivity]).
  apply E. intros v. rewrite (tally_more _ _ open (if mem o v then 1 else 0)). destruct (X v), (mem o v); simpl; lia.
Qed.

Lemma greatest_enough : forall X w b, cnt all X <= b -> forall k total,
  sum all (fun v => Nat.b2n (X v) * Nat.min (w v) k) + total <= greatest b (map w all) k total.
Proof.
  intros X w b B k. induction k as [|k IH]; intros total; cbn [greatest].
  - rewrite sum_zero by (intros; rewrite Nat.min_0_r; lia). lia.
  - apply Nat.le_trans with (2 := IH _). rewrite tally_cnt, cnt_map, smaller_min.
    assert (sum all (fun v => Nat.b2n (X v) * Nat.min (w v) (S k)) <=
            sum all (fun v => Nat.b2n (X v) * Nat.min (w v) k) + cnt all (fun v => X v && (S k <=? w v))).
    { rewrite cnt_sum, <- sum_add. apply sum_le. intros v _. destruct (Nat.leb_spec (S k) (w v)), (X v); simpl Nat.b2n; cbn [andb]; lia. }
    assert (cnt all (fun v => X v && (S k <=? w v)) <= cnt all X) by (apply cnt_le; intros v _ E; apply andb_true_iff in E; tauto).
    assert (cnt all (fun v => X v && (S k <=? w v)) <= cnt all (fun v => S k <=? w v))
      by (apply cnt_le; intros v _ E; apply andb_true_iff in E; tauto).
    lia.
Qed.

Lemma shares_sound : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> shares t s = true.
Proof.
  intros N1 N2 M1 M2 s S ST. unfold shares. pose proof (few_more _ _ _ _ _ S (on_bad _ _ _ _ _ ST)) as FM.
  destruct (local t); [reflexivity|]. cbv zeta.
  pose proof (wants_sound _ _ _ _ _ S ST (groups (asks t)) (pT (here s)) 0 [] (groups_ok _ _ _ _ OK)) as W1. cbv zeta in W1.
  destruct (wants _ (pT (here s)) _ _ _ _ _) as [w1 o1]. specialize (W1 (Nat.le_0_l _)).
  pose proof (wants_sound _ _ _ _ _ (solution_swap _ _ _ _ S) (suits_flip _ _ _ _ _ ST) (groups (asks t)) (pT (there s)) w1 o1 (groups_ok _ _ _ _ OK)) as W2.
  cbv zeta in W2. cbn [flip here there bad] in W2.
  rewrite (open_sum_ext o1 (more_bad M2 M1 (bad s)) (more_bad M1 M2 (bad s))) in W2
    by (intros v; unfold more_bad; rewrite (orb_comm (M2 v)); reflexivity).
  specialize (W2 W1). destruct (wants _ (pT (there s)) _ _ _ _ _) as [wanted open].
  rewrite (open_sum_ext open (more_bad M2 M1 (bad s)) (more_bad M1 M2 (bad s))) in W2
    by (intros v; unfold more_bad; rewrite (orb_comm (M2 v)); reflexivity).
  destruct (wanted =? 0); [reflexivity|]. apply Nat.leb_le. apply Nat.le_trans with (1 := W2). rewrite open_sum_votes.
  unfold votes. rewrite (limit_ok _ _ _ _ OK).
  pose proof (greatest_enough (more_bad M1 M2 (bad s)) (fun v => tally (fun o => mem o v) open 0) (left_total t (bad s))) as G.
  unfold left_total in G at 1. change (count 0 (full (asks t)) (bad s)) with (size_of t (bad s)) in G. rewrite size_is in G.
  specialize (G ltac:(lia) (tally (fun _ => true) open 0) 0). rewrite Nat.add_0_r in G.
  apply Nat.le_trans with (2 := G). apply sum_le. intros v _.
  assert (tally (fun o => mem o v) open 0 <= tally (fun _ => true) open 0) by apply tally_most.
  rewrite Nat.min_l by assumption. lia.
Qed.

(* *count* *)
Ltac count_by_points := rewrite ?cnt_sum, <- ?sum_add; apply sum_le; intros v _.
Ltac numerals := apply Nat.leb_le; reflexivity.

Lemma crowds_out_sound : forall N1 N2 M1 M2 s x y, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> row_ok x -> row_ok y ->
  N1 (id x) = true -> N2 (id y) = true -> crowds_out t s x y = true -> False.
Proof.
  intros N1 N2 M1 M2 s x y S ST OX OY NX NY C. unfold crowds_out in C. cbv zeta in C. apply Nat.ltb_lt in C.
  pose proof (held_1 _ _ _ _ S _ NX) as KX. pose proof (held_2 _ _ _ _ S _ NY) as KY.
  rewrite <- (ok_need _ _ _ _ OX) in KX. rewrite <- (ok_need _ _ _ _ OY) in KY.
  pose proof (left_enough _ _ _ _ _ x S (on_bad _ _ _ _ _ ST) OX NX) as LX.
  pose proof (left_enough _ _ _ _ _ y (solution_swap _ _ _ _ S) (on_bad _ _ _ _ _ (suits_flip _ _ _ _ _ ST)) OY NY) as LY.
  cbn [flip bad] in LY.
  pose proof (few_more _ _ _ _ _ S (on_bad _ _ _ _ _ ST)) as FM.
  set (a := here s) in *. set (b := there s) in *. set (Z := bad s) in *.
  set (hy := diff (hear y) (self x)) in *. set (hx := diff (hear x) (self y)) in *.
  set (sy := inter hy (sure_of b Z)) in *. set (sx := inter hx (sure_of a Z)) in *. set (either := union sy sx) in *.
  set (my := diff (inter hy (pQ b)) Z) in *. set (mx := diff (inter hx (pQ a)) Z) in *.
  assert (GY : forall v, h (id y) v && (N2 v || M2 v) = true -> mem hy v = true /\
            (mem sy v = true \/ (mem my v = true /\ more_bad M1 M2 Z v = true))).
  { intros v V. apply andb_true_iff in V. destruct V as [HV V].
    assert (HY : mem hy v = true).
    { unfold hy. rewrite mem_diff, (ok_hear _ _ _ _ OY), HV. simpl. apply negb_true_iff. apply not_true_is_false. intros W.
      apply (ok_self _ _ _ _ OX) in W. subst v. apply orb_true_iff in V. destruct (clean_1 _ _ _ _ S _ NX).
      destruct V as [V|V]; [exact (not_both _ _ _ _ S _ NX V)|congruence]. }
    split; [assumption|]. unfold sy. rewrite mem_inter, HY. simpl. destruct (mem (sure_of b Z) v) eqn:D; [auto|right].
    destruct (not_sure _ _ _ _ _ v (suits_flip _ _ _ _ _ ST) V D) as (Q1 & Q2 & Q3). cbn [flip bad here] in Q1, Q2. fold b Z in Q1, Q2.
    unfold more_bad in *. rewrite (orb_comm (M1 v)). split; [|exact Q2]. unfold my. rewrite mem_diff, mem_inter, HY.
    pose proof (on_Q _ _ _ (on_there _ _ _ _ _ ST) v Q3) as QQ. fold b in QQ. rewrite QQ. simpl. apply andb_true_iff in Q2. tauto. }
  assert (GX : forall v, h (id x) v && (N1 v || M1 v) = true -> mem hx v = true /\
            (mem sx v = true \/ (mem mx v = true /\ more_bad M1 M2 Z v = true))).
  { intros v V. apply andb_true_iff in V. destruct V as [HV V].
    assert (HX : mem hx v = true).
    { unfold hx. rewrite mem_diff, (ok_hear _ _ _ _ OX), HV. simpl. apply negb_true_iff. apply not_true_is_false. intros W.
      apply (ok_self _ _ _ _ OY) in W. subst v. apply orb_true_iff in V. destruct (clean_2 _ _ _ _ S _ NY).
      destruct V as [V|V]; [exact (not_both _ _ _ _ S _ V NY)|congruence]. }
    split; [assumption|]. unfold sx. rewrite mem_inter, HX. simpl. destruct (mem (sure_of a Z) v) eqn:D; [auto|right].
    destruct (not_sure _ _ _ _ _ v ST V D) as (Q1 & Q2 & Q3). fold Z in Q2. split; [|exact Q2].
    unfold mx. rewrite mem_diff, mem_inter, HX. 
    pose proof (on_Q _ _ _ (on_here _ _ _ _ _ ST) v Q3) as QQ. fold a in QQ. rewrite QQ. simpl.
    unfold more_bad in Q2. apply andb_true_iff in Q2. tauto. }
  assert (HY : forall v, mem my v = true -> h (id y) v = true).
  { intros v V. unfold my, hy in V. rewrite mem_diff, mem_inter, mem_diff, (ok_hear _ _ _ _ OY) in V.
    destruct (h (id y) v); [reflexivity|discriminate]. }
  assert (HX : forall v, mem mx v = true -> h (id x) v = true).
  { intros v V. unfold mx, hx in V. rewrite mem_diff, mem_inter, mem_diff, (ok_hear _ _ _ _ OX) in V.
    destruct (h (id x) v); [reflexivity|discriminate]. }
  assert (EI : forall v, mem either v = mem sy v || mem sx v) by (intros; apply mem_union).
  rewrite !size_is in C. set (ly := left_of t Z (left_total t Z) y) in *. set (lx := left_of t Z (left_total t Z) x) in *.
  assert (LT : local t = false -> cnt all (more_bad M1 M2 Z) <= left_total t Z).
  { intros E. rewrite E in FM. unfold left_total. change (count 0 (full (asks t)) Z) with (size_of t Z). rewrite size_is. lia. }
  set (two_ways := cnt all (mem (diff (inter my mx) either))) in *.
  set (only_y := cnt all (mem (diff (diff my mx) either))) in *. set (only_x := cnt all (mem (diff (diff mx my) either))) in *.
  set (gy := fun v => h (id y) v && (N2 v || M2 v)) in *. set (gx := fun v => h (id x) v && (N1 v || M1 v)) in *.
  set (more := more_bad M1 M2 Z) in *.
  set (A := fun v => gy v && more v && mem my v && negb (mem either v)).
  set (B := fun v => gx v && more v && mem mx v && negb (mem either v)).
  assert (CA : cnt all A <= only_y + two_ways).
  { unfold only_y, two_ways. count_by_points. rewrite !mem_diff, mem_inter. unfold A.
    destruct (gy v), (more v), (mem my v), (mem mx v), (mem either v); numerals. }
  assert (CB : cnt all B <= only_x + two_ways).
  { unfold only_x, two_ways. count_by_points. rewrite !mem_diff, mem_inter. unfold B.
    destruct (gx v), (more v), (mem my v), (mem mx v), (mem either v); numerals. }
  pose proof (of_faces _ _ _ _ S) as OF. destruct two.
  - (* two faces: M1 = M2 *)
    set (again := cnt all (mem (inter (inter my mx) either))) in *. set (thrice := cnt all (mem (inter (inter sy sx) Z))) in *.
    set (A' := fun v => more v && mem my v && negb (mem either v)). set (B' := fun v => more v && mem mx v && negb (mem either v)).
    set (C' := fun v => more v && mem my v && mem mx v && mem either v).
    assert (POINT : cnt all gy + cnt all gx <= cnt all (mem either) + thrice + cnt all A' + cnt all B' + cnt all C').
    { unfold thrice. count_by_points. specialize (GY v). specialize (GX v). specialize (EI v). rewrite !mem_inter.
      fold (gy v) in GY. fold (gx v) in GX. unfold A', B', C'.
      assert (Zv : gy v = true -> gx v = true -> more v = false -> mem Z v = true /\ mem sy v = true /\ mem sx v = true).
      { intros Y1 X1 MO. destruct (GY Y1) as (_ & [Y2|[_ Y2]]); [|congruence]. destruct (GX X1) as (_ & [X2|[_ X2]]); [|congruence].
        split; [|auto]. unfold gy in Y1. unfold gx in X1. apply andb_true_iff in Y1, X1. destruct Y1 as [_ Y1], X1 as [_ X1].
        apply orb_true_iff in Y1, X1. unfold more, more_bad in MO.
        assert (MM : M1 v || M2 v = true).
        { destruct X1 as [X1|X1]; [|rewrite X1; reflexivity]. destruct Y1 as [Y1|Y1]; [destruct (not_both _ _ _ _ S v X1 Y1)|].
          rewrite Y1. apply orb_true_r. }
        rewrite MM in MO. simpl in MO. apply negb_false_iff in MO. exact MO. }
      assert (MQ : gy v = true -> gx v = true -> more v = true -> mem my v = true /\ mem mx v = true).
      { intros Y1 X1 MO. destruct (GY Y1) as (Y2 & _). destruct (GX X1) as (X2 & _). unfold more, more_bad in MO.
        apply andb_true_iff in MO. destruct MO as [MO NZ]. rewrite OF in MO. rewrite orb_diag in MO.
        unfold my, mx. rewrite !mem_diff, !mem_inter, X2, Y2.
        pose proof (on_Q _ _ _ (on_there _ _ _ _ _ ST) v MO) as Q1. rewrite <- OF in MO.
        pose proof (on_Q _ _ _ (on_here _ _ _ _ _ ST) v MO) as Q2. fold b in Q1. fold a in Q2. rewrite Q1, Q2, NZ. auto. }
      destruct (gy v), (gx v); simpl Nat.b2n; [| | |lia].
      - destruct (more v) eqn:MO.
        + destruct (MQ eq_refl eq_refl eq_refl) as [Q1 Q2]. rewrite Q1, Q2. destruct (mem either v); simpl; lia.
        + destruct (Zv eq_refl eq_refl eq_refl) as (Q1 & Q2 & Q3). rewrite EI, Q1, Q2, Q3. simpl. lia.
      - destruct (GY eq_refl) as (_ & [Q|[Q1 Q2]]); [rewrite EI, Q; simpl; lia|]. fold (more v) in Q2. rewrite Q1, Q2.
        destruct (mem either v); simpl; lia.
      - destruct (GX eq_refl) as (_ & [Q|[Q1 Q2]]); [rewrite EI, Q, orb_true_r; simpl; lia|]. fold (more v) in Q2. rewrite Q1, Q2.
        destruct (mem either v); simpl; lia. }
    assert (CA' : cnt all A' <= only_y + two_ways).
    { unfold only_y, two_ways. count_by_points. rewrite !mem_diff, mem_inter. unfold A'.
      destruct (more v), (mem my v), (mem mx v), (mem either v); numerals. }
    assert (CB' : cnt all B' <= only_x + two_ways).
    { unfold only_x, two_ways. count_by_points. rewrite !mem_diff, mem_inter. unfold B'.
      destruct (more v), (mem my v), (mem mx v), (mem either v); numerals. }
    assert (CC' : cnt all C' <= again).
    { apply cnt_le. intros v _ V. rewrite !mem_inter. unfold C' in V. destruct (more v), (mem my v), (mem mx v), (mem either v); auto. }
    destruct (local t).
    + assert (AC : cnt all A' + cnt all C' <= ly).
      { apply Nat.le_trans with (2 := LY). count_by_points. specialize (HY v). unfold A', C'. unfold more_bad. rewrite (orb_comm (M2 v)).
        fold (more_bad M1 M2 Z v). fold more.
        destruct (h (id y) v), (more v), (mem my v), (mem mx v), (mem either v); try numerals; discriminate (HY eq_refl). }
      assert (BC : cnt all B' + cnt all C' <= lx).
      { apply Nat.le_trans with (2 := LX). count_by_points. specialize (HX v). unfold B', C'. fold (more v).
        destruct (h (id x) v), (more v), (mem my v), (mem mx v), (mem either v); try numerals; discriminate (HX eq_refl). }
      rewrite !smaller_min in C. lia.
    + specialize (LT eq_refl). set (E' := fun v => more v && mem my v && mem mx v && negb (mem either v)).
      set (O' := fun v => more v && xorb (mem my v) (mem mx v) && negb (mem either v)).
      assert (E1 : cnt all A' + cnt all B' <= cnt all E' + cnt all E' + cnt all O').
      { count_by_points. unfold A', B', E', O'. destruct (more v), (mem my v), (mem mx v), (mem either v); numerals. }
      assert (E2 : cnt all E' <= two_ways).
      { apply cnt_le. intros v _ V. rewrite mem_diff, mem_inter. unfold E' in V. destruct (more v), (mem my v), (mem mx v), (mem either v); auto. }
      assert (E3 : cnt all O' <= only_y + only_x).
      { unfold only_y, only_x. count_by_points. rewrite !mem_diff. unfold O'. destruct (more v), (mem my v), (mem mx v), (mem either v); numerals. }
      assert (E4 : cnt all E' + cnt all O' + cnt all C' <= left_total t Z).
      { apply Nat.le_trans with (2 := LT). count_by_points. unfold E', O', C'. fold (more v).
        destruct (more v), (mem my v), (mem mx v), (mem either v); numerals. }
      rewrite !smaller_min in C. lia.
  - (* one face: nobody is inside both sides *)
    assert (EX : forall v, gy v = true -> gx v = true -> False).
    { intros v Y X. unfold gy in Y. unfold gx in X. apply andb_true_iff in Y, X. destruct Y as [_ Y], X as [_ X].
      apply orb_true_iff in Y, X. destruct X as [X|X]; [destruct (clean_1 _ _ _ _ S v X)|]; destruct Y as [Y|Y];
        try (destruct (clean_2 _ _ _ _ S v Y)); try congruence.
      - exact (not_both _ _ _ _ S v X Y).
      - exact (OF v X Y). }
    assert (POINT : cnt all gy + cnt all gx <= cnt all (mem either) + cnt all A + cnt all B).
    { count_by_points. specialize (GY v). specialize (GX v). specialize (EI v). specialize (EX v). fold (gy v) in GY. fold (gx v) in GX.
      unfold A, B. destruct (gy v), (gx v); simpl Nat.b2n; [| | |lia].
      - destruct (EX eq_refl eq_refl).
      - destruct (GY eq_refl) as (_ & [Q|[Q1 Q2]]); [rewrite EI, Q; simpl; lia|]. fold (more v) in Q2. rewrite Q1, Q2.
        destruct (mem either v); simpl; lia.
      - destruct (GX eq_refl) as (_ & [Q|[Q1 Q2]]); [rewrite EI, Q, orb_true_r; simpl; lia|]. fold (more v) in Q2. rewrite Q1, Q2.
        destruct (mem either v); simpl; lia. }
    destruct (local t).
    + assert (AL : cnt all A <= ly).
      { apply Nat.le_trans with (2 := LY). apply cnt_le. intros v _ V. specialize (HY v). unfold A in V. unfold more_bad.
        rewrite (orb_comm (M2 v)). fold (more_bad M1 M2 Z v). fold more.
        destruct (gy v), (more v), (mem my v), (mem either v); try discriminate. rewrite HY by reflexivity. reflexivity. }
      assert (BL : cnt all B <= lx).
      { apply Nat.le_trans with (2 := LX). apply cnt_le. intros v _ V. specialize (HX v). unfold B in V. fold (more v).
        destruct (gx v), (more v), (mem mx v), (mem either v); try discriminate. rewrite HX by reflexivity. reflexivity. }
      rewrite !smaller_min in C. lia.
    + specialize (LT eq_refl).
      assert (E1 : cnt all A + cnt all B <= left_total t Z).
      { apply Nat.le_trans with (2 := LT). count_by_points. specialize (EX v). unfold A, B.
        destruct (gy v), (gx v), (more v), (mem my v), (mem mx v), (mem either v); try numerals; exfalso; auto. }
      assert (E2 : cnt all A + cnt all B <= only_y + only_x + two_ways).
      { unfold only_y, only_x, two_ways. count_by_points. specialize (EX v). rewrite !mem_diff, mem_inter. unfold A, B.
        destruct (gy v), (gx v), (more v), (mem my v), (mem mx v), (mem either v); try numerals; exfalso; auto. }
      rewrite !smaller_min in C. lia.
Qed.
End Threat.
