(* The graph of Proposition 1 as the paper describes it (docs/constructions.md): what its proof claims and what is so. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Proposition1.
Import ListNotations.

(* The graph of the paper, read literally: G1 is a clique of 4f nodes, G2, G3 and G4 are cliques of f nodes. All nodes of
   G4 hear the same 2f nodes of G1; a node of G3 hears f nodes of G1, and of G2 f others, and both hear all of G4. *)
Definition literal (f : nat) : digraph :=
  Digraph (7 * f) (fun i j =>
    negb (j =? i) &&
    (if i <? 4 * f then j <? 4 * f
     else if i <? 5 * f then interval (3 * f) f j || interval (4 * f) f j || interval (6 * f) f j
     else if i <? 6 * f then interval (2 * f) f j || interval (5 * f) f j || interval (6 * f) f j
     else (j <? 2 * f) || interval (6 * f) f j)).

(* It is not (f+1,f+1)-robust, as the proof in the paper says: of G3 and G4 against G1 and G2 only G4 is reached. *)
Theorem the_literal_graph_is_not_f1_f1_robust : forall f, 1 <= f -> ~ robust (literal f) (f + 1) (f + 1).
Proof.
  intros f F [_ R]. set (A := fun i => 5 * f <=? i). set (B := fun i => i <? 5 * f).
  assert (FEW : forall i X low, low + f <= 7 * f ->
    (forall j, hears (literal f) i j && negb (X j) = true -> j < 7 * f -> interval low f j = true) -> reachable (literal f) (f + 1) X i = false).
  { intros i X low N H. unfold reachable, size. cbn [nodes literal]. apply not_true_is_false. intros E. apply andb_true_iff in E.
    destruct E as [_ E]. apply Nat.leb_le in E.
    assert (cnt (seq 0 (7 * f)) (fun j => hears (literal f) i j && negb (X j)) <= cnt (seq 0 (7 * f)) (interval low f)).
    { apply cnt_le. intros j J. apply in_seq in J. intros Q. apply H; [exact Q|lia]. }
    rewrite (cnt_interval_all (7 * f) low f N) in H0. lia. }
  assert (G1 : forall i, i < 4 * f -> reachable (literal f) (f + 1) B i = false).
  { intros i I. apply FEW with (low := 0); [lia|]. intros j Q J. exfalso. cbn [hears literal] in Q. unfold B in Q.
    destruct (Nat.ltb_spec i (4 * f)); [|lia]. destruct (Nat.ltb_spec j (4 * f)), (Nat.ltb_spec j (5 * f)); try lia;
      rewrite ?andb_false_r in Q; discriminate. }
  assert (G2 : forall i, 4 * f <= i -> i < 5 * f -> reachable (literal f) (f + 1) B i = false).
  { intros i I I'. apply FEW with (low := 6 * f); [lia|]. intros j Q J. cbn [hears literal] in Q. unfold B in Q.
    destruct (Nat.ltb_spec i (4 * f)); [lia|]. destruct (Nat.ltb_spec i (5 * f)); [|lia].
    destruct (Nat.ltb_spec j (5 * f)); [rewrite andb_false_r in Q; discriminate|].
    apply andb_true_iff in Q. destruct Q as [Q _]. apply andb_true_iff in Q. destruct Q as [_ Q]. rewrite !orb_true_iff in Q.
    destruct Q as [[Q|Q]|Q]; [apply interval_true in Q; lia|apply interval_true in Q; lia|assumption]. }
  assert (G3 : forall i, 5 * f <= i -> i < 6 * f -> reachable (literal f) (f + 1) A i = false).
  { intros i I I'. apply FEW with (low := 2 * f); [lia|]. intros j Q J. cbn [hears literal] in Q. unfold A in Q.
    destruct (Nat.ltb_spec i (4 * f)); [lia|]. destruct (Nat.ltb_spec i (5 * f)); [lia|]. destruct (Nat.ltb_spec i (6 * f)); [|lia].
    destruct (Nat.leb_spec (5 * f) j); [rewrite andb_false_r in Q; discriminate|].
    apply andb_true_iff in Q. destruct Q as [Q _]. apply andb_true_iff in Q. destruct Q as [_ Q]. rewrite !orb_true_iff in Q.
    destruct Q as [[Q|Q]|Q]; [assumption|apply interval_true in Q; lia|apply interval_true in Q; lia]. }
  assert (XA : nonempty (literal f) A) by (exists (5 * f); split; [simpl; lia|apply Nat.leb_le; lia]).
  assert (XB : nonempty (literal f) B) by (exists 0; split; [simpl; lia|apply Nat.ltb_lt; lia]).
  destruct (R A B XA XB) as [Q|[Q|Q]].
  - intros i _ P P'. apply Nat.leb_le in P. apply Nat.ltb_lt in P'. lia.
  - specialize (Q (5 * f) ltac:(simpl; lia)). rewrite G3 in Q by lia. unfold A in Q. destruct (Nat.leb_spec (5 * f) (5 * f)); [discriminate|lia].
  - specialize (Q 0 ltac:(simpl; lia)). rewrite G1 in Q by lia. unfold B in Q. destruct (Nat.ltb_spec 0 (5 * f)); [discriminate|lia].
  - assert (SA : size (literal f) (reachable (literal f) (f + 1) A) <= f).
    { apply Nat.le_trans with (cnt (seq 0 (7 * f)) (interval (6 * f) f)); [|rewrite cnt_interval_all; lia].
      unfold size. cbn [nodes literal]. apply cnt_le. intros i I E. apply in_seq in I. apply interval_true. destruct (le_lt_dec (6 * f) i); [lia|exfalso]. destruct (le_lt_dec (5 * f) i).
      - rewrite G3 in E by lia. discriminate.
      - unfold reachable, A in E. destruct (Nat.leb_spec (5 * f) i); [lia|discriminate]. }
    assert (SB : size (literal f) (reachable (literal f) (f + 1) B) = 0).
    { unfold size. apply cnt_false. intros i I. destruct (le_lt_dec (4 * f) i); [|apply G1; assumption].
      destruct (le_lt_dec (5 * f) i); [|apply G2; assumption]. unfold reachable, B. destruct (Nat.ltb_spec i (5 * f)); [lia|reflexivity]. }
    lia.
Qed.

(* For f = 1 its least in-degree is 2, below 2f + 1. *)
Theorem the_literal_graph_has_an_in_degree_of_2 : exists i, i < nodes (literal 1) /\ size (literal 1) (hears (literal 1) i) = 2.
Proof. exists 4. split; [simpl; lia|reflexivity]. Qed.
