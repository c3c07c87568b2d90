(* Traps: none for f if and only if the network is (f+1)-robust without any f nodes, or, with the local bound, without any
   nodes that obey it (docs/theorems.md, Terms). *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Evidence Apart.
Import ListNotations.

(* A trap: sets of two faces, in total, that hold apart. *)
Definition trap (G : digraph) (f : nat) (M S1 S2 : set) : Prop := apart G f true false M S1 S2.

(* The nodes that are left without M; (f+1)-robustness of what is left. *)
Definition left_without (G : digraph) (M : set) : list nat := filter (fun v => negb (M v)) (seq 0 (nodes G)).

Lemma cnt_filter : forall l p f, cnt (filter p l) f = cnt l (fun v => p v && f v).
Proof.
  intros l p f. induction l as [|v l IH]; [reflexivity|]. simpl. destruct (p v) eqn:E; rewrite ?cnt_cons, IH, ?E; reflexivity.
Qed.

Theorem no_trap_iff_robust_without : forall G f local,
  together G f true local <-> (forall M, obeys G f local M -> no_pair (left_without G M) (hears G) (f + 1) 1).
Proof.
  intros G f local. set (V := seq 0 (nodes G)).
  assert (O : forall M S i, outside (left_without G M) (hears G) S i = size G (fun j => hears G i j && negb (S j || M j))).
  { intros M S i. unfold outside, left_without, size. rewrite cnt_filter. apply cnt_ext. intros v _.
    destruct (hears G i v), (S v), (M v); reflexivity. }
  assert (IN : forall M i, In i (left_without G M) <-> i < nodes G /\ M i = false).
  { intros M i. unfold left_without. rewrite filter_In, in_seq, negb_true_iff. lia || (split; intros [A B]; split; auto; lia). }
  split.
  - intros NT M FEW S1 S2 (i & I & Si) (j & J & Sj) D.
    destruct (all_or_one (left_without G M) (hears G) (f + 1) S1) as [|E1]; [auto|].
    destruct (all_or_one (left_without G M) (hears G) (f + 1) S2) as [|E2]; [auto|].
    right. right. destruct (cnt (left_without G M) (reach (left_without G M) (hears G) (f + 1) S1)
                            + cnt (left_without G M) (reach (left_without G M) (hears G) (f + 1) S2)) eqn:C; [exfalso|lia].
    assert (DEAF : forall S, cnt (left_without G M) (reach (left_without G M) (hears G) (f + 1) S) = 0 ->
      forall k, k < nodes G -> S k && negb (M k) = true -> size G (fun j => hears G k j && negb (S j && negb (M j) || M j)) <= f).
    { intros S Z k K Q. apply andb_true_iff in Q. destruct Q as [Q1 Q2]. apply negb_true_iff in Q2.
      destruct (le_lt_dec (outside (left_without G M) (hears G) S k) f) as [L|L].
      - rewrite O in L. apply Nat.le_trans with (2 := L). apply cnt_le. intros v _ P. destruct (hears G k v), (S v), (M v); auto.
      - assert (1 <= cnt (left_without G M) (reach (left_without G M) (hears G) (f + 1) S)); [|lia].
        apply cnt_pos with k; [apply IN; auto|]. unfold reach. rewrite Q1. apply Nat.leb_le. lia. }
    apply IN in I, J.
    assert (OFF : forall S k, k < nodes G -> M k = true -> S k && negb (M k) = true -> False)
      by (intros S k _ A B; rewrite A, andb_false_r in B; discriminate).
    apply (NT M (fun v => S1 v && negb (M v)) (fun v => S2 v && negb (M v))). split.
    + assumption.
    + exists i. destruct I as [I I']. rewrite Si, I'. auto.
    + exists j. destruct J as [J J']. rewrite Sj, J'. auto.
    + intros k K A B. apply andb_true_iff in A, B. destruct A as [A A'], B as [B _]. apply negb_true_iff in A'.
      apply (D k); [apply IN|assumption|assumption]. auto.
    + split; intros k K; apply OFF; assumption.
    + intros k K A _. apply DEAF; [lia|assumption|assumption].
    + intros k K A _. apply DEAF; [lia|assumption|assumption].
  - intros NP M S1 S2 [FEW (i & I & Si & Mi) (j & J & Sj & Mj) D [D1 D2] G1 G2].
    assert (F1 : forall k, k < nodes G -> S1 k = true -> size G (fun j => hears G k j && negb (S1 j || M j)) <= f).
    { intros k K Sk. apply G1; [assumption|assumption|]. destruct (M k) eqn:Mk; [exfalso; exact (D1 k K Mk Sk)|reflexivity]. }
    assert (F2 : forall k, k < nodes G -> S2 k = true -> size G (fun j => hears G k j && negb (S2 j || M j)) <= f).
    { intros k K Sk. apply G2; [assumption|assumption|]. destruct (M k) eqn:Mk; [exfalso; exact (D2 k K Mk Sk)|reflexivity]. }
    assert (Z : forall S, (forall k, k < nodes G -> S k = true -> size G (fun j => hears G k j && negb (S j || M j)) <= f) ->
      cnt (left_without G M) (reach (left_without G M) (hears G) (f + 1) S) = 0).
    { intros S H. apply cnt_false. intros k K. apply IN in K. destruct K as [K _]. unfold reach. destruct (S k) eqn:Sk; [|reflexivity].
      rewrite O. specialize (H k K Sk). apply Nat.leb_gt. lia. }
    destruct (NP M FEW S1 S2) as [Q|[Q|Q]].
    + exists i. split; [apply IN; auto|assumption].
    + exists j. split; [apply IN; auto|assumption].
    + intros k K. apply IN in K. apply D. tauto.
    + specialize (Q i (proj2 (IN M i) (conj I Mi)) Si). rewrite O in Q. specialize (F1 i I Si). lia.
    + specialize (Q j (proj2 (IN M j) (conj J Mj)) Sj). rewrite O in Q. specialize (F2 j J Sj). lia.
    + rewrite !Z in Q by assumption. lia.
Qed.
