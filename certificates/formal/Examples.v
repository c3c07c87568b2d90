(* Where the source paper is wrong, by computation (docs/lemma-1.md): the definition is tried on all pairs of sets. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Evidence Lemmas Apart.
Import ListNotations.

(* All sets of nodes below n, as lists of truth values. *)
Fixpoint all_lists (n : nat) : list (list bool) :=
  match n with 0 => [[]] | S n' => flat_map (fun l => [true :: l; false :: l]) (all_lists n') end.
Definition set_of (l : list bool) : set := fun i => nth i l false.

Lemma all_lists_all : forall l, In l (all_lists (length l)).
Proof.
  induction l as [|b l IH]; [left; reflexivity|]. simpl. apply in_flat_map. exists l. split; [assumption|].
  destruct b; simpl; auto.
Qed.

(* The definition, tried. *)
Definition try_pair (G : digraph) (r s : nat) (A B : set) : bool :=
  let V := seq 0 (nodes G) in
  if negb (existsb A V) then true else if negb (existsb B V) then true else if existsb (fun i => A i && B i) V then true
  else if forallb (fun i => eqb (reachable G r A i) (A i)) V then true
  else if forallb (fun i => eqb (reachable G r B i) (B i)) V then true
  else s <=? size G (reachable G r A) + size G (reachable G r B).
Definition try (G : digraph) (r s : nat) : bool :=
  ((negb (nodes G =? 1)) || (r <=? 1)) &&
  forallb (fun a => forallb (fun b => try_pair G r s (set_of a) (set_of b)) (all_lists (nodes G))) (all_lists (nodes G)).

Theorem try_sound : forall G r s, try G r s = true -> robust G r s.
Proof.
  intros G r s T. unfold try in T. apply andb_true_iff in T. destruct T as [ONE T]. split.
  - intros O. rewrite O in ONE. simpl in ONE. apply Nat.leb_le. exact ONE.
  - intros S1 S2 (i & I & Si) (j & J & Sj) D. set (V := seq 0 (nodes G)).
    set (a := map S1 V). set (b := map S2 V).
    assert (NA : forall S k, k < nodes G -> set_of (map S V) k = S k).
    { intros S k K. unfold set_of. rewrite (nth_indep _ false (S 0)) by (rewrite map_length; unfold V; rewrite seq_length; assumption).
      rewrite map_nth. unfold V. rewrite seq_nth by assumption. reflexivity. }
    assert (LEN : forall S : set, In (map S V) (all_lists (nodes G))).
    { intros S. replace (nodes G) with (length (map S V)) by (rewrite map_length; unfold V; apply seq_length). apply all_lists_all. }
    rewrite forallb_forall in T. specialize (T a (LEN S1)). rewrite forallb_forall in T. specialize (T b (LEN S2)).
    assert (R : forall S k, k < nodes G -> reachable G r (set_of (map S V)) k = reachable G r S k).
    { intros S k K. unfold reachable. rewrite NA by assumption. f_equal. f_equal. apply cnt_ext. intros v Q. apply in_seq in Q.
      rewrite NA by lia. reflexivity. }
    assert (Z : forall S, size G (reachable G r (set_of (map S V))) = size G (reachable G r S))
      by (intros S; apply cnt_ext; intros v Q; apply in_seq in Q; apply R; lia).
    assert (SAME : forall S, forallb (fun i => eqb (reachable G r (set_of (map S V)) i) (set_of (map S V) i)) V = true ->
      same G (reachable G r S) S).
    { intros S F k K. rewrite forallb_forall in F. specialize (F k). rewrite R, NA in F by assumption.
      apply eqb_prop. apply F. unfold V. apply in_seq. lia. }
    unfold try_pair in T. fold V in T. cbv zeta in T.
    destruct (negb (existsb (set_of a) V)) eqn:T1; [clear T; rename T1 into T|clear T1].
    2: destruct (negb (existsb (set_of b) V)) eqn:T1; [clear T; rename T1 into T|clear T1].
    3: destruct (existsb (fun i => set_of a i && set_of b i) V) eqn:T1; [clear T; rename T1 into T|clear T1].
    4: destruct (forallb (fun i => eqb (reachable G r (set_of a) i) (set_of a i)) V) eqn:T1; [clear T; rename T1 into T|clear T1].
    5: destruct (forallb (fun i => eqb (reachable G r (set_of b) i) (set_of b i)) V) eqn:T1; [clear T; rename T1 into T|clear T1].
    + exfalso. apply negb_true_iff in T. assert (existsb (set_of a) V = true); [|congruence]. apply existsb_exists. exists i.
      unfold a. rewrite NA by assumption. split; [unfold V; apply in_seq; lia|assumption].
    + exfalso. apply negb_true_iff in T. assert (existsb (set_of b) V = true); [|congruence]. apply existsb_exists. exists j.
      unfold b. rewrite NA by assumption. split; [unfold V; apply in_seq; lia|assumption].
    + exfalso. apply existsb_exists in T. destruct T as (k & K & E). unfold V in K. apply in_seq in K.
      unfold a, b in E. rewrite !NA in E by lia. apply andb_true_iff in E. apply (D k); tauto || lia.
    + left. apply SAME. exact T.
    + right. left. apply SAME. exact T.
    + right. right. unfold a, b in T. rewrite !Z in T. apply Nat.leb_le. exact T.
Qed.

(* Section 4: K_5 is not the only 3-robust graph on 5 nodes; K_5 without the edge 0-2 is. *)
Definition K5_without_02 : digraph :=
  Digraph 5 (fun i j => negb (i =? j) && negb ((i =? 0) && (j =? 2)) && negb ((i =? 2) && (j =? 0))).
Theorem K5_without_an_edge_is_3_robust : robust K5_without_02 3 1.
Proof. apply try_sound. vm_compute. reflexivity. Qed.

(* Lemma 1 (iii) and (iv), and the least in-degree, for digraphs: two nodes of which one hears the other. *)
Definition one_arc : digraph := Digraph 2 (fun i j => (i =? 0) && (j =? 1)).
Theorem a_1_robust_digraph_with_a_node_that_hears_nobody : robust one_arc 1 1 /\ size one_arc (hears one_arc 1) = 0.
Proof. split; [apply try_sound; vm_compute|]; reflexivity. Qed.
Definition no_arc : digraph := Digraph 2 (fun _ _ => false).
Theorem a_graph_without_arcs_is_0_robust : robust no_arc 0 1.
Proof. apply try_sound. vm_compute. reflexivity. Qed.

(* The converse of the last line: K_2 is (1,2)-robust and not 2-robust. *)
Definition K2 : digraph := Digraph 2 (fun i j => negb (i =? j)).
Theorem the_last_line_has_no_converse : robust K2 1 2 /\ ~ robust K2 2 1.
Proof.
  split; [apply try_sound; vm_compute; reflexivity|]. intros [_ R].
  destruct (R (fun i => i =? 0) (fun i => i =? 1)) as [Q|[Q|Q]].
  - exists 0. split; [simpl; lia|reflexivity].
  - exists 1. split; [simpl; lia|reflexivity].
  - intros i _ A B. apply Nat.eqb_eq in A, B. lia.
  - specialize (Q 0). simpl in Q. discriminate Q. lia.
  - specialize (Q 1). simpl in Q. discriminate Q. lia.
  - vm_compute in Q. lia.
Qed.

(* (2f+1)-robustness is not necessary for having no trap: K_{3f+1} has none. *)
Theorem no_trap_and_not_2f1_robust : forall f, 1 <= f ->
  together (complete (3 * f + 1)) f true false /\ ~ robust (complete (3 * f + 1)) (2 * f + 1) 1.
Proof.
  intros f F. set (n := 3 * f + 1). split.
  - intros M S1 S2 [BM (i & I & Si & Mi) (j & J & Sj & Mj) D [D1 D2] F1 F2]. unfold obeys in BM. cbv beta iota in BM.
    assert (BIG : forall S k, k < n -> S k = true -> (forall v, v < n -> S v = true -> M v = true -> False) ->
      size (complete n) (fun j => hears (complete n) k j && negb (S j || (true && M j))) <= f -> n <= cnt (seq 0 n) S + cnt (seq 0 n) M + f).
    { intros S k K Sk DM H. apply Nat.le_trans with (cnt (seq 0 n) S + cnt (seq 0 n) M + size (complete n) (fun j => hears (complete n) k j && negb (S j || (true && M j)))); [|lia].
      rewrite <- (seq_length n 0) at 1. rewrite <- (cnt_true (seq 0 n) (fun _ => true)) by reflexivity. unfold size. cbn [nodes complete hears].
      rewrite !cnt_sum, <- !sum_add. apply sum_le. intros v _. destruct (Nat.eqb_spec v k) as [E|E]; [subst v; rewrite Sk; destruct (M k)|destruct (S v), (M v)]; simpl; lia. }
    specialize (BIG S1 i I Si (fun v V A B => D1 v V B A) (F1 i I Si Mi)) as B1.
    specialize (BIG S2 j J Sj (fun v V A B => D2 v V B A) (F2 j J Sj Mj)) as B2.
    assert (ALL : cnt (seq 0 n) S1 + cnt (seq 0 n) S2 + cnt (seq 0 n) M <= n).
    { rewrite <- (seq_length n 0) at 4. rewrite <- (cnt_true (seq 0 n) (fun _ => true)) by reflexivity.
      rewrite !cnt_sum, <- !sum_add. apply sum_le. intros v V. apply in_seq in V. specialize (D v ltac:(simpl; lia)).
      specialize (D1 v ltac:(simpl; lia)). specialize (D2 v ltac:(simpl; lia)).
      destruct (S1 v), (S2 v), (M v); simpl; try lia; exfalso; auto. }
    unfold size in BM. cbn [nodes complete] in BM. lia.
  - intros R. apply lemma_1_v in R; [|simpl; lia|lia]. cbn [nodes complete] in R.
    pose proof (Nat.div_mod_eq (n + 1) 2). pose proof (Nat.mod_upper_bound (n + 1) 2). lia.
Qed.
