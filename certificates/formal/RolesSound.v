(* Every rule keeps the solutions that a state stands for, or finds that there are none. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Sets Tables Rules Soundness Refutation Roles.
Import ListNotations.

(* What a question says of its graph. *)
Record sound_threat (n : nat) (h : nat -> nat -> bool) (needs : nat -> nat) (t : threat) : Prop := {
  range_ok : forall i v, h i v = true -> v < n;
  groups_ok : Forall (Forall (row_ok n h needs)) (groups (asks t));
  ids_ok : Forall (Forall (fun x => id x < n)) (groups (asks t));
  row_of_ok : forall v x, row_of (asks t) v = Some x -> row_ok n h needs x;
  full_ok : forall v, mem (full (asks t)) v = (v <? n);
  limit_ok : limit (asks t) = n }.

Section Threat.
Variable n : nat.                       (* nodes *)
Variable h : nat -> nat -> bool.        (* h i v: i hears v *)
Variable needs : nat -> nat.            (* k_i *)
Variable t : threat.
Hypothesis OK : sound_threat n h needs t.

Notation all := (seq 0 n).
Notation two := (two_faces t).
Notation f := (most t).
Notation row_ok := (row_ok n h needs).

(* A solution: the normal members of both sides, and who of M is inside them. *)
Record solution (N1 N2 M1 M2 : nat -> bool) : Prop := {
  in_N1 : forall v, N1 v = true -> v < n;
  in_N2 : forall v, N2 v = true -> v < n;
  in_M1 : forall v, M1 v = true -> v < n;
  in_M2 : forall v, M2 v = true -> v < n;
  not_both : forall v, N1 v = true -> N2 v = true -> False;
  clean_1 : forall v, N1 v = true -> M1 v = false /\ M2 v = false;
  clean_2 : forall v, N2 v = true -> M1 v = false /\ M2 v = false;
  of_faces : forall v, if two then M1 v = M2 v else M1 v = true -> M2 v = true -> False;
  some_1 : exists v, N1 v = true;
  some_2 : exists v, N2 v = true;
  held_1 : forall i, N1 i = true -> needs i <= cnt all (fun v => h i v && (N1 v || M1 v));
  held_2 : forall i, N2 i = true -> needs i <= cnt all (fun v => h i v && (N2 v || M2 v));
  limited : if local t then forall i, i < n -> M1 i || M2 i = false -> cnt all (fun v => h i v && (M1 v || M2 v)) <= f
            else cnt all (fun v => M1 v || M2 v) <= f }.

Lemma solution_swap : forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> solution N2 N1 M2 M1.
Proof.
  intros N1 N2 M1 M2 []. split; auto.
  - intros v A B. eauto.
  - intros v A. destruct (clean_4 v A). auto.
  - intros v A. destruct (clean_3 v A). auto.
  - intros v. specialize (of_faces0 v). destruct two; [congruence|auto].
  - destruct (local t).
    + intros i I E. rewrite orb_comm in E. apply Nat.le_trans with (2 := limited0 i I E). apply cnt_le.
      intros v _ A. rewrite (orb_comm (M1 v)). exact A.
    + apply Nat.le_trans with (2 := limited0). apply cnt_le. intros v _ A. rewrite orb_comm. exact A.
Qed.

(* The sets of a solution may be those of a state. *)
Record fits (N M : nat -> bool) (a : part) : Prop := {
  on_P : forall v, N v = true -> mem (pP a) v = true;
  on_Q : forall v, M v = true -> mem (pQ a) v = true;
  on_F : forall v, mem (pF a) v = true -> N v || M v = true;
  on_T : forall v, mem (pT a) v = true -> N v = true }.
Record suits (N1 N2 M1 M2 : nat -> bool) (s : roles) : Prop := {
  on_here : fits N1 M1 (here s);
  on_there : fits N2 M2 (there s);
  on_bad : forall v, mem (bad s) v = true -> M1 v || M2 v = true }.

Lemma suits_flip : forall N1 N2 M1 M2 s, suits N1 N2 M1 M2 s -> suits N2 N1 M2 M1 (flip s).
Proof. intros N1 N2 M1 M2 s []. split; auto. intros v A. rewrite orb_comm. apply on_bad0. exact A. Qed.

(* *role* *)
Definition keeps (op : roles -> roles) : Prop :=
  forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> suits N1 N2 M1 M2 (op s).

Lemma keeps_both : forall op, keeps op -> keeps (both op).
Proof.
  intros op K N1 N2 M1 M2 s S ST. unfold both. apply suits_flip. apply K; [apply solution_swap; assumption|].
  apply suits_flip. apply K; assumption.
Qed.
Lemma keeps_compose : forall op1 op2, keeps op1 -> keeps op2 -> keeps (fun s => op2 (op1 s)).
Proof. intros op1 op2 K1 K2 N1 N2 M1 M2 s S ST. apply K2; [assumption|]. apply K1; assumption. Qed.

Lemma inside_T_keeps : keeps inside_T.
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. split; [split|exact B|exact C]; auto. cbn. intros v V.
  rewrite mem_union in V. apply orb_true_iff in V. destruct V as [V|V]; [auto|]. rewrite (A4 v V). reflexivity.
Qed.
Lemma not_normal_keeps : keeps not_normal.
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. split; [split|exact B|exact C]; auto. cbn. intros v V.
  rewrite mem_diff, mem_union, (A2 v V). simpl. apply negb_true_iff, orb_false_iff. split; apply not_true_is_false; intros W.
  - destruct (clean_1 _ _ _ _ S v (A4 v W)). congruence.
  - destruct (clean_2 _ _ _ _ S v (on_T _ _ _ B v W)). congruence.
Qed.
Lemma by_faces_keeps : keeps (by_faces two).
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. pose proof (of_faces _ _ _ _ S) as OF. unfold by_faces. destruct two.
  - split; [split|exact B|]; auto. cbn. intros v V. rewrite mem_union, mem_inter in V. apply orb_true_iff in V. destruct V as [V|V]; [auto|].
    apply andb_true_iff in V. destruct V as [V1 V2]. apply A3 in V1. apply (on_F _ _ _ B) in V2. specialize (OF v).
    destruct (N1 v) eqn:E; [|simpl in V1; rewrite V1; reflexivity]. destruct (N2 v) eqn:E2; [exfalso; exact (not_both _ _ _ _ S v E E2)|].
    simpl in V2. rewrite V2. apply orb_true_r.
  - split; [split|exact B|exact C]; auto. cbn. intros v V. rewrite mem_diff, (A2 v V). simpl. apply negb_true_iff.
    apply not_true_is_false. intros W. apply (on_F _ _ _ B) in W. apply orb_true_iff in W. destruct W as [W|W]; [|exact (OF v V W)].
    destruct (clean_2 _ _ _ _ S v W). congruence.
Qed.
Lemma not_P_keeps : keeps not_P.
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. split; [split|exact B|]; auto. cbn. intros v V.
  rewrite mem_union, mem_diff in V. apply orb_true_iff in V. destruct V as [V|V]; [auto|].
  apply andb_true_iff in V. destruct V as [V1 V2]. apply A3 in V1. destruct (N1 v) eqn:E; [rewrite (A1 v E) in V2; discriminate|].
  simpl in V1. rewrite V1. reflexivity.
Qed.
Lemma no_room_keeps : keeps no_room.
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. split; [split|exact B|exact C]; auto. cbn. intros v V.
  rewrite mem_diff, mem_union, (A1 v V). simpl. destruct (clean_1 _ _ _ _ S v V) as [E1 E2].
  apply negb_true_iff, orb_false_iff. split; apply not_true_is_false; intros W.
  - apply C in W. rewrite E1, E2 in W. discriminate.
  - apply (on_F _ _ _ B) in W. rewrite E2, orb_false_r in W. exact (not_both _ _ _ _ S v V W).
Qed.
Lemma inside_Z_keeps : keeps (inside_Z two).
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. pose proof (of_faces _ _ _ _ S) as OF.
  split; [split|exact B|exact C]; auto. cbn. intros v V. rewrite mem_union in V. apply orb_true_iff in V. destruct V as [V|V]; [auto|].
  specialize (OF v). destruct two.
  - apply C in V. rewrite <- OF in V. destruct (M1 v); [apply orb_true_r|discriminate].
  - rewrite mem_diff in V. apply andb_true_iff in V. destruct V as [V1 V2]. apply C in V1.
    destruct (M2 v) eqn:E; [rewrite (on_Q _ _ _ B v E) in V2; discriminate|]. rewrite orb_false_r in V1. rewrite V1. apply orb_true_r.
Qed.
Lemma not_Q_keeps : keeps not_Q.
Proof.
  intros N1 N2 M1 M2 s S [[A1 A2 A3 A4] B C]. split; [split|exact B|exact C]; auto. cbn. intros v V.
  rewrite mem_union, mem_diff in V. apply orb_true_iff in V. destruct V as [V|V]; [auto|].
  apply andb_true_iff in V. destruct V as [V1 V2]. apply A3 in V1. destruct (M1 v) eqn:E; [rewrite (A2 v E) in V2; discriminate|].
  rewrite orb_false_r in V1. exact V1.
Qed.

Lemma role_once_keeps : keeps (role_once two).
Proof.
  unfold role_once. intros N1 N2 M1 M2 s S ST.
  apply keeps_both; [|assumption|].
  - intros K1 K2 L1 L2 u SU U. apply not_Q_keeps; [assumption|]. apply inside_Z_keeps; [assumption|]. apply no_room_keeps; assumption.
  - repeat (apply keeps_both; [first [apply not_P_keeps|apply by_faces_keeps|apply not_normal_keeps|apply inside_T_keeps]|assumption|]).
    assumption.
Qed.
Lemma role_keeps : forall fuel, keeps (role fuel two).
Proof.
  induction fuel as [|fuel IH]; intros N1 N2 M1 M2 s S ST; [assumption|]. cbn [role]. cbv zeta.
  pose proof (role_once_keeps _ _ _ _ _ S ST). destruct (equal_roles _ _); [assumption|apply IH; assumption].
Qed.

Lemma possible : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> impossible two s = false.
Proof.
  intros N1 N2 M1 M2 s S [A B C]. unfold impossible. apply orb_false_iff. split; [apply orb_false_iff; split; [apply orb_false_iff; split|]|].
  - apply negb_false_iff. apply subset_true. intros v V. apply C in V. rewrite mem_union. apply orb_true_iff in V. apply orb_true_iff.
    destruct V as [V|V]; [left; apply (on_Q _ _ _ A v V)|right; apply (on_Q _ _ _ B v V)].
  - destruct (some_1 _ _ _ _ S) as (v & V). apply not_true_is_false. intros E. pose proof (isempty_mem _ v E) as W.
    rewrite (on_P _ _ _ A v V) in W. discriminate.
  - destruct (some_2 _ _ _ _ S) as (v & V). apply not_true_is_false. intros E. pose proof (isempty_mem _ v E) as W.
    rewrite (on_P _ _ _ B v V) in W. discriminate.
  - pose proof (of_faces _ _ _ _ S) as OF. destruct two; [reflexivity|]. simpl. apply negb_false_iff. apply isempty_true. intros v.
    rewrite mem_inter. apply not_true_is_false. intros V. apply andb_true_iff in V. destruct V as [V W].
    apply (on_F _ _ _ A) in V. apply (on_F _ _ _ B) in W. apply orb_true_iff in V, W.
    destruct V as [V|V]; [destruct (clean_1 _ _ _ _ S v V)|]; destruct W as [W|W]; try (destruct (clean_2 _ _ _ _ S v W)); try congruence.
    + exact (not_both _ _ _ _ S v V W).
    + exact (OF v V W).
Qed.

(* Counting in sets of nodes. *)
Lemma size_is : forall A, size_of t A = cnt all (mem A).
Proof.
  intros A. unfold size_of. rewrite (count_spec _ A 0 (Sets.size * length (full (asks t)) + n)) by lia. simpl.
  rewrite (cnt_seq_cut n); [|lia|intros v V; rewrite (full_ok _ _ _ _ OK); destruct (Nat.ltb_spec v n); [lia|reflexivity]].
  apply cnt_ext. intros v V. apply in_seq in V. rewrite (full_ok _ _ _ _ OK). destruct (Nat.ltb_spec v n); [reflexivity|lia].
Qed.
Lemma heard_in : forall x D, row_ok x -> count 0 (hear x) D = cnt all (fun v => h (id x) v && mem D v).
Proof. intros. apply (count_hear n h needs (range_ok _ _ _ _ OK)); assumption. Qed.

(* Further malicious nodes: of M, and not in Z. *)
Definition more_bad (M1 M2 : nat -> bool) (Z : bits) (v : nat) : bool := (M1 v || M2 v) && negb (mem Z v).

Lemma few_more : forall N1 N2 M1 M2 Z, solution N1 N2 M1 M2 -> (forall v, mem Z v = true -> M1 v || M2 v = true) ->
  if local t then forall i, i < n -> M1 i || M2 i = false -> cnt all (fun v => h i v && mem Z v) + cnt all (fun v => h i v && more_bad M1 M2 Z v) <= f
  else cnt all (mem Z) + cnt all (more_bad M1 M2 Z) <= f.
Proof.
  intros N1 N2 M1 M2 Z S HZ. pose proof (limited _ _ _ _ S) as L. destruct (local t).
  - intros i I E. apply Nat.le_trans with (2 := L i I E). rewrite !cnt_sum, <- sum_add. apply sum_le. intros v _. unfold more_bad.
    specialize (HZ v). destruct (mem Z v); [rewrite HZ by reflexivity|]; destruct (h i v), (M1 v || M2 v); simpl; lia.
  - apply Nat.le_trans with (2 := L). rewrite !cnt_sum, <- sum_add. apply sum_le. intros v _. unfold more_bad.
    specialize (HZ v). destruct (mem Z v); [rewrite HZ by reflexivity|]; destruct (M1 v || M2 v); simpl; lia.
Qed.

(* *budget* *)
Lemma budget_total_sound : forall N1 N2 M1 M2 s, local t = false -> solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
  match budget_total f (full (asks t)) s with Some u => suits N1 N2 M1 M2 u | None => False end.
Proof.
  intros N1 N2 M1 M2 s LOC S ST. pose proof (few_more _ _ _ _ (bad s) S (on_bad _ _ _ _ _ ST)) as FM. rewrite LOC in FM.
  unfold budget_total. change (count 0 (full (asks t)) (bad s)) with (size_of t (bad s)). rewrite size_is.
  destruct (Nat.ltb_spec f (cnt all (mem (bad s)))); [lia|]. destruct (Nat.eqb_spec (cnt all (mem (bad s))) f) as [E|]; [|assumption].
  assert (Z : forall v, M1 v || M2 v = true -> mem (bad s) v = true).
  { intros v V. destruct (mem (bad s) v) eqn:W; [reflexivity|exfalso]. assert (1 <= cnt all (more_bad M1 M2 (bad s))); [|lia].
    apply cnt_pos with v; [|unfold more_bad; rewrite V, W; reflexivity]. apply in_seq. apply orb_true_iff in V.
    destruct V as [V|V]; [apply (in_M1 _ _ _ _ S) in V|apply (in_M2 _ _ _ _ S) in V]; lia. }
  destruct ST as [[A1 A2 A3 A4] [B1 B2 B3 B4] C]. split; [split|split|]; cbn; auto; intros v V; rewrite mem_inter.
  - rewrite (A2 v V). apply Z. rewrite V. reflexivity.
  - rewrite (B2 v V). apply Z. rewrite V. apply orb_true_r.
Qed.

Definition bad_fine (M1 M2 : nat -> bool) (Z Qa Qb : bits) : Prop :=
  (forall v, mem Z v = true -> M1 v || M2 v = true) /\ (forall v, M1 v = true -> mem Qa v = true) /\ (forall v, M2 v = true -> mem Qb v = true).

Lemma budget_word_sound : forall N1 N2 M1 M2 maybe, local t = true -> solution N1 N2 M1 M2 -> (forall v, M1 v || M2 v = true -> mem maybe v = true) ->
  forall rows w Z Qa Qb, Forall row_ok rows -> Forall (fun x => id x < n) rows -> bad_fine M1 M2 Z Qa Qb ->
  match budget_word rows w f maybe Z Qa Qb with Some (Z', Qa', Qb') => bad_fine M1 M2 Z' Qa' Qb' | None => False end.
Proof.
  intros N1 N2 M1 M2 maybe LOC S MB rows w. induction rows as [|x rest IH]; intros Z Qa Qb O I FI; [assumption|].
  inversion O as [|? ? OX OR]; subst. inversion I as [|? ? IX IR]; subst. cbn [budget_word]. cbv zeta.
  destruct (w_is0 (w_and w (bit x))); [apply IH; assumption|]. destruct FI as (F1 & F2 & F3).
  pose proof (few_more _ _ _ _ Z S F1) as FM. rewrite LOC in FM. specialize (FM (id x) IX). rewrite heard_in by assumption.
  destruct (Nat.ltb_spec f (cnt all (fun v => h (id x) v && mem Z v))) as [G|G].
  - assert (MX : M1 (id x) || M2 (id x) = true) by (destruct (M1 (id x) || M2 (id x)); [reflexivity|specialize (FM eq_refl); lia]).
    rewrite (MB _ MX). apply IH; try assumption. split; [|auto]. intros v V. rewrite mem_union in V. apply orb_true_iff in V.
    destruct V as [V|V]; [auto|]. apply (ok_self _ _ _ _ OX) in V. subst. assumption.
  - destruct (_ && negb _) eqn:E; [|apply IH; try assumption; repeat split; assumption].
    apply andb_true_iff in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E1. apply negb_true_iff in E2.
    assert (NX : M1 (id x) || M2 (id x) = false) by (apply not_true_is_false; intros Q; rewrite (MB _ Q) in E2; discriminate).
    specialize (FM NX).
    assert (K : forall v, M1 v || M2 v = true -> mem (diff (hear x) Z) v = false).
    { intros v V. rewrite mem_diff, (ok_hear _ _ _ _ OX). destruct (h (id x) v) eqn:HV; [|reflexivity]. simpl. apply negb_false_iff.
      destruct (mem Z v) eqn:W; [reflexivity|exfalso]. assert (1 <= cnt all (fun v => h (id x) v && more_bad M1 M2 Z v)); [|lia].
      apply cnt_pos with v; [apply in_seq; apply (range_ok _ _ _ _ OK) in HV; lia|]. unfold more_bad. rewrite HV, V, W. reflexivity. }
    apply IH; try assumption. split; [assumption|]. split; intros v V; rewrite mem_diff, K by (rewrite V; rewrite ?orb_true_r; reflexivity).
    + rewrite (F2 v V). reflexivity.
    + rewrite (F3 v V). reflexivity.
Qed.
Lemma budget_local_sound : forall N1 N2 M1 M2 maybe, local t = true -> solution N1 N2 M1 M2 -> (forall v, M1 v || M2 v = true -> mem maybe v = true) ->
  forall groups nodes Z Qa Qb, Forall (Forall row_ok) groups -> Forall (Forall (fun x => id x < n)) groups -> bad_fine M1 M2 Z Qa Qb ->
  match budget_local groups nodes f maybe Z Qa Qb with Some (Z', Qa', Qb') => bad_fine M1 M2 Z' Qa' Qb' | None => False end.
Proof.
  intros N1 N2 M1 M2 maybe LOC S MB groups. induction groups as [|rows groups IH]; intros nodes Z Qa Qb O I FI; [assumption|].
  inversion O as [|? ? OX OR]; subst. inversion I as [|? ? IX IR]; subst. destruct nodes as [|w nodes]; [assumption|]. cbn [budget_local].
  destruct (w_is0 w); [apply IH; assumption|].
  pose proof (budget_word_sound _ _ _ _ maybe LOC S MB rows w Z Qa Qb OX IX FI) as W.
  destruct (budget_word _ _ _ _ _ _ _) as [[[Z' Qa'] Qb']|]; [|contradiction]. apply IH; assumption.
Qed.
Lemma budget_sound : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
  match budget t s with Some u => suits N1 N2 M1 M2 u | None => False end.
Proof.
  intros N1 N2 M1 M2 s S ST. unfold budget. destruct (local t) eqn:LOC; [|apply budget_total_sound; assumption].
  destruct ST as [[A1 A2 A3 A4] [B1 B2 B3 B4] C].
  pose proof (budget_local_sound N1 N2 M1 M2 (union (pQ (here s)) (pQ (there s))) LOC S) as BL.
  specialize (BL ltac:(intros v V; rewrite mem_union; apply orb_true_iff in V; apply orb_true_iff; destruct V; auto)).
  specialize (BL (groups (asks t)) (diff (full (asks t)) (bad s)) (bad s) (pQ (here s)) (pQ (there s)) (groups_ok _ _ _ _ OK) (ids_ok _ _ _ _ OK) (conj C (conj A2 B2))).
  destruct (budget_local _ _ _ _ _ _ _) as [[[Z Qa] Qb]|]; [|assumption]. destruct BL as (G1 & G2 & G3).
  split; [split|split|]; cbn; auto.
Qed.

(* Whom a normal node hears inside its side. *)
Lemma not_sure : forall N1 N2 M1 M2 s v, suits N1 N2 M1 M2 s -> N1 v || M1 v = true -> mem (sure_of (here s) (bad s)) v = false ->
  mem (loose_of (here s) (bad s)) v = true /\ more_bad M1 M2 (bad s) v = true /\ M1 v = true.
Proof.
  intros N1 N2 M1 M2 s v [[A1 A2 A3 A4] B C] I D. pose proof D as D'. unfold sure_of in D.
  rewrite !mem_union, mem_inter in D. apply orb_false_iff in D. destruct D as [D DZ]. apply orb_false_iff in D. destruct D as [DP DF].
  destruct (N1 v) eqn:E; [rewrite (A1 v E) in DP; discriminate|]. simpl in I. rewrite (A2 v I), andb_true_r in DZ.
  unfold loose_of. rewrite mem_diff, (A2 v I), D'. unfold more_bad. rewrite I, DZ. auto.
Qed.

Lemma left_enough : forall N1 N2 M1 M2 Z x, solution N1 N2 M1 M2 -> (forall v, mem Z v = true -> M1 v || M2 v = true) -> row_ok x ->
  N1 (id x) = true -> cnt all (fun v => h (id x) v && more_bad M1 M2 Z v) <= left_of t Z (left_total t Z) x.
Proof.
  intros N1 N2 M1 M2 Z x S HZ O NX. pose proof (few_more _ _ _ _ Z S HZ) as FM. unfold left_of, left_total. destruct (local t).
  - destruct (clean_1 _ _ _ _ S _ NX) as [E1 E2]. specialize (FM (id x) (in_N1 _ _ _ _ S _ NX)). rewrite E1, E2 in FM.
    specialize (FM eq_refl). rewrite heard_in by assumption. lia.
  - change (count 0 (full (asks t)) Z) with (size_of t Z). rewrite size_is.
    assert (cnt all (fun v => h (id x) v && more_bad M1 M2 Z v) <= cnt all (more_bad M1 M2 Z)); [|lia].
    apply cnt_le. intros v _ E. apply andb_true_iff in E. tauto.
Qed.

Lemma held_parts : forall N1 N2 M1 M2 s x, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> row_ok x -> N1 (id x) = true ->
  let D := sure_of (here s) (bad s) in let L := loose_of (here s) (bad s) in
  let inside := fun v => h (id x) v && (N1 v || M1 v) in
  need x <= cnt all (fun v => inside v && mem D v) + cnt all (fun v => inside v && negb (mem D v)) /\
  cnt all (fun v => inside v && mem D v) <= count 0 (hear x) D /\
  cnt all (fun v => inside v && negb (mem D v)) <= count 0 (hear x) L /\
  cnt all (fun v => inside v && negb (mem D v)) <= left_of t (bad s) (left_total t (bad s)) x.
Proof.
  intros N1 N2 M1 M2 s x S ST O NX D L inside. rewrite !heard_in by assumption.
  assert (NS : forall v, inside v && negb (mem D v) = true -> h (id x) v = true /\ mem L v = true /\ more_bad M1 M2 (bad s) v = true).
  { intros v V. unfold inside in V. apply andb_true_iff in V. destruct V as [V ND]. apply andb_true_iff in V. destruct V as [HV V].
    apply negb_true_iff in ND. destruct (not_sure _ _ _ _ _ v ST V ND) as (Q1 & Q2 & _). auto. }
  split; [|split; [|split]].
  - rewrite <- cnt_split. rewrite (ok_need _ _ _ _ O). apply (held_1 _ _ _ _ S). assumption.
  - apply cnt_le. intros v _ V. unfold inside in V. destruct (h (id x) v); simpl in *; [|discriminate]. apply andb_true_iff in V. tauto.
  - apply cnt_le. intros v _ V. destruct (NS v V) as (Q1 & Q2 & _). rewrite Q1, Q2. reflexivity.
  - apply Nat.le_trans with (2 := left_enough _ _ _ _ _ x S (on_bad _ _ _ _ _ ST) O NX). apply cnt_le.
    intros v _ V. destruct (NS v V) as (Q1 & _ & Q3). rewrite Q1, Q3. reflexivity.
Qed.

(* *peel* and *force* *)
Definition agrees (N M : nat -> bool) (P F : bits) : Prop :=
  (forall v, N v = true -> mem P v = true) /\ (forall v, mem F v = true -> N v || M v = true).

Lemma agrees_peel : forall N M P F x, agrees N M P F -> row_ok x -> N (id x) = false -> agrees N M (diff P (self x)) F.
Proof.
  intros N M P F x [A B] O U. split; [|assumption]. intros v V. rewrite mem_diff, (A v V). simpl. apply negb_true_iff.
  destruct (mem (self x) v) eqn:W; [|reflexivity]. apply (ok_self _ _ _ _ O) in W. subst. congruence.
Qed.

Lemma force_sound : forall N1 N2 M1 M2 s x, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> row_ok x -> N1 (id x) = true ->
  let D := sure_of (here s) (bad s) in let L := loose_of (here s) (bad s) in
  let extra := count 0 (hear x) L in let b := left_of t (bad s) (left_total t (bad s)) x in
  count 0 (hear x) D + smaller extra b = need x ->
  forall v, mem (inter (hear x) (if extra <=? b then union D L else D)) v = true -> N1 v || M1 v = true.
Proof.
  intros N1 N2 M1 M2 s x S ST O NX D L extra b E v V. rewrite mem_inter, (ok_hear _ _ _ _ O) in V. apply andb_true_iff in V.
  destruct V as [HV V]. destruct (held_parts _ _ _ _ _ _ S ST O NX) as (P1 & P2 & P3 & P4). fold D in P1, P2, P3, P4.
  fold L in P3. fold extra in P3. fold b in P4. rewrite smaller_min in E.
  assert (EX : extra = cnt all (fun v => h (id x) v && mem L v)) by (apply heard_in; assumption). clearbody extra b.
  assert (VN : In v all) by (apply in_seq; apply (range_ok _ _ _ _ OK) in HV; lia).
  destruct (N1 v || M1 v) eqn:NV; [reflexivity|exfalso]. destruct (mem D v) eqn:DV.
  - assert (cnt all (fun v => h (id x) v && (N1 v || M1 v) && mem D v) < count 0 (hear x) D); [|lia].
    rewrite heard_in by assumption. apply cnt_lt with v; auto; [|rewrite HV, DV; reflexivity|rewrite NV, andb_false_r; reflexivity].
    intros u _ U. destruct (h (id x) u); simpl in *; [|discriminate]. apply andb_true_iff in U. tauto.
  - destruct (Nat.leb_spec extra b) as [LE|]; [|congruence]. rewrite mem_union, DV in V. simpl in V.
    assert (LT : cnt all (fun v => h (id x) v && (N1 v || M1 v) && negb (mem D v)) < cnt all (fun v => h (id x) v && mem L v)).
    { apply cnt_lt with v; auto; [|rewrite HV, V; reflexivity|rewrite NV, andb_false_r; reflexivity].
      intros u _ U. apply andb_true_iff in U. destruct U as [U ND]. apply andb_true_iff in U. destruct U as [HU U].
      apply negb_true_iff in ND. destruct (not_sure _ _ _ _ _ u ST U ND) as (Q & _). fold L in Q. rewrite HU, Q. reflexivity. }
    lia.
Qed.

Lemma hark_word_sound : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> forall rows w P F,
  Forall row_ok rows -> agrees N1 M1 P F ->
  match hark_word t (left_total t (bad s)) rows w (sure_of (here s) (bad s)) (loose_of (here s) (bad s)) (bad s) (pT (here s)) P F with
  | Some (P', F') => agrees N1 M1 P' F' | None => False end.
Proof.
  intros N1 N2 M1 M2 s S ST rows w. induction rows as [|x rest IH]; intros P F O AG; [assumption|].
  inversion O as [|? ? OX OR]; subst. cbn [hark_word]. cbv zeta.
  destruct (w_is0 (w_and w (bit x))); [apply IH; assumption|].
  set (D := sure_of (here s) (bad s)) in *. set (L := loose_of (here s) (bad s)) in *.
  destruct (need x <? count 0 (hear x) D); [apply IH; assumption|].
  set (b := left_of t (bad s) (left_total t (bad s)) x).
  destruct (Nat.ltb_spec (count 0 (hear x) D + smaller (count 0 (hear x) L) b) (need x)) as [U|U].
  - assert (NX : N1 (id x) = false).
    { apply not_true_is_false. intros NX. destruct (held_parts _ _ _ _ _ _ S ST OX NX) as (P1 & P2 & P3 & P4).
      fold D in P1, P2, P3, P4. fold L in P3. fold b in P4. rewrite smaller_min in U. lia. }
    destruct (mem (pT (here s)) (id x)) eqn:T.
    + apply (on_T _ _ _ (on_here _ _ _ _ _ ST)) in T. congruence.
    + apply IH; [assumption|]. apply agrees_peel; assumption.
  - destruct (_ && mem (pT (here s)) (id x)) eqn:E; [|apply IH; assumption]. apply andb_true_iff in E. destruct E as [E T].
    apply Nat.eqb_eq in E. apply (on_T _ _ _ (on_here _ _ _ _ _ ST)) in T.
    pose proof (force_sound _ _ _ _ _ _ S ST OX T E) as FS. apply IH; [assumption|]. destruct AG as [G1 G2]. split; [assumption|].
    intros v V. rewrite mem_union in V. apply orb_true_iff in V. destruct V; auto.
Qed.
Lemma hark_sound : forall N1 N2 M1 M2 s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> forall groups nodes P F,
  Forall (Forall row_ok) groups -> agrees N1 M1 P F ->
  match hark t (left_total t (bad s)) groups nodes (sure_of (here s) (bad s)) (loose_of (here s) (bad s)) (bad s) (pT (here s)) P F with
  | Some (P', F') => agrees N1 M1 P' F' | None => False end.
Proof.
  intros N1 N2 M1 M2 s S ST groups. induction groups as [|rows groups IH]; intros nodes P F O AG; [assumption|].
  inversion O as [|? ? OX OR]; subst. destruct nodes as [|w nodes]; [assumption|]. cbn [hark].
  destruct (w_is0 w); [apply IH; assumption|].
  pose proof (hark_word_sound _ _ _ _ _ S ST rows w P F OX AG) as W.
  destruct (hark_word _ _ _ _ _ _ _ _ _ _) as [[P' F']|]; [|contradiction]. apply IH; assumption.
Qed.
End Threat.
