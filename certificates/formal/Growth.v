(* Growth: a robust seed, and nodes that each hear r + s - 1 of those before (Lemma 4). *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness Tables Evidence Checks.
Import ListNotations.

(* Nodes to places in the seed, and back. *)
Fixpoint index_from (l : list nat) (i : nat) (t : table nat) : table nat :=
  match l with [] => t | v :: l' => index_from l' (S i) (set v i t) end.
Fixpoint places_from (l : list nat) (i : nat) (t : table nat) : table nat :=
  match l with [] => t | v :: l' => places_from l' (S i) (set i v t) end.
Definition pick (index : table nat) (l : list nat) : list nat :=
  fold_left (fun found u => match get u index with Some j => j :: found | None => found end) l [].

Definition induced (seed : list nat) (heard : nat -> list nat) : nat -> list nat :=
  let index := index_from seed 0 Leaf in
  let places := places_from seed 0 Leaf in
  fun i => match get i places with Some v => pick index (heard v) | None => [] end.
Definition induced_hears (seed : list nat) (h : nat -> nat -> bool) (i j : nat) : bool :=
  (i <? length seed) && (j <? length seed) && h (nth i seed 0) (nth j seed 0).

Lemma index_spec : forall l i t v j, NoDup l -> get v (index_from l i t) = Some j ->
  (exists k, k < length l /\ j = i + k /\ nth k l 0 = v) \/ (~ In v l /\ get v t = Some j).
Proof.
  induction l as [|a l IH]; intros i t v j N G; [right; auto|]. inversion N; subst. simpl in G.
  destruct (IH (S i) _ v j H2 G) as [(k & K & E & V)|[NI E]].
  - left. exists (S k). simpl. repeat split; [lia|lia|assumption].
  - rewrite get_set in E. destruct (Nat.eqb_spec v a) as [->|NE].
    + injection E as <-. left. exists 0. simpl. repeat split; lia.
    + right. split; [|assumption]. intros [Q|Q]; [congruence|contradiction].
Qed.

Lemma index_none : forall l i t v, ~ In v l -> get v (index_from l i t) = get v t.
Proof.
  induction l as [|a l IH]; intros i t v N; [reflexivity|]. simpl. rewrite IH by (intros Q; apply N; right; assumption).
  rewrite get_set. destruct (Nat.eqb_spec v a) as [->|]; [exfalso; apply N; left; reflexivity|reflexivity].
Qed.

Lemma index_some : forall l i t k, NoDup l -> k < length l -> get (nth k l 0) (index_from l i t) = Some (i + k).
Proof.
  induction l as [|a l IH]; intros i t k N K; [simpl in K; lia|]. inversion N; subst. destruct k as [|k]; simpl.
  - rewrite index_none by assumption. rewrite get_set, Nat.eqb_refl. f_equal. lia.
  - simpl in K. rewrite IH by (assumption || lia). f_equal. lia.
Qed.

Lemma places_some : forall l i t k, (k < i -> get k (places_from l i t) = get k t) /\
  (k < length l -> get (i + k) (places_from l i t) = Some (nth k l 0)).
Proof.
  induction l as [|a l IH]; intros i t k; split; intros K; simpl in *; [reflexivity|lia| |].
  - destruct (IH (S i) (set i a t) k) as [A _]. rewrite A by lia. rewrite get_set. destruct (Nat.eqb_spec k i); [lia|reflexivity].
  - destruct k as [|k].
    + destruct (IH (S i) (set i a t) i) as [A _]. rewrite Nat.add_0_r, A by lia. rewrite get_set, Nat.eqb_refl. reflexivity.
    + destruct (IH (S i) (set i a t) k) as [_ B]. replace (i + S k) with (S i + k) by lia. apply B. lia.
Qed.

Lemma pick_spec : forall index l, NoDup l -> (forall u v j, get u index = Some j -> get v index = Some j -> u = v) ->
  NoDup (pick index l) /\ forall j, In j (pick index l) <-> exists u, In u l /\ get u index = Some j.
Proof.
  intros index l N INJ. unfold pick.
  assert (H : forall l found, NoDup l -> NoDup found -> (forall u j, In u l -> get u index = Some j -> ~ In j found) ->
    let result := fold_left (fun found u => match get u index with Some j => j :: found | None => found end) l found in
    NoDup result /\ forall j, In j result <-> In j found \/ exists u, In u l /\ get u index = Some j).
  { clear l N. induction l as [|u l IH]; intros found N NF D; simpl.
    - split; [assumption|]. intros j. split; [auto|]. intros [Q|(u & [] & _)]; assumption.
    - inversion N; subst. destruct (get u index) as [j|] eqn:G.
      + destruct (IH (j :: found)) as [A B]; [assumption| | |].
        * constructor; [|assumption]. apply (D u j); [left; reflexivity|assumption].
        * intros v k V K [Q|Q]; [|apply (D v k); [right; assumption|assumption|assumption]].
          subst k. assert (u = v) by eauto. subst. contradiction.
        * split; [exact A|]. intros k. rewrite B. simpl. split.
          -- intros [[->|Q]|(v & V & K)]; [right; exists u; auto|auto|right; exists v; auto].
          -- intros [Q|(v & [->|V] & K)]; [auto| |right; exists v; auto]. left. left. congruence.
      + destruct (IH found) as [A B]; [assumption|assumption| |].
        * intros v k V K. apply (D v k); [right; assumption|assumption].
        * split; [exact A|]. intros k. rewrite B. split.
          -- intros [Q|(v & V & K)]; [auto|right; exists v; auto].
          -- intros [Q|(v & [->|V] & K)]; [auto|congruence|right; exists v; auto]. }
  destruct (H l [] N (NoDup_nil _)) as [A B]; [simpl; auto|]. split; [exact A|]. intros j. rewrite B. simpl. split; [|auto].
  intros [[]|Q]. assumption.
Qed.

Section Graph.
Variable n : nat.
Variable h : nat -> nat -> bool.
Variable heard : nat -> list nat.
Hypothesis h_range : forall i v, h i v = true -> v < n.
Hypothesis h_loop : forall i, h i i = false.
Hypothesis heard_ok : lists n h heard.

Lemma induced_ok : forall seed, NoDup seed -> (forall v, In v seed -> v < n) ->
  lists (length seed) (induced_hears seed h) (induced seed heard).
Proof.
  intros seed N B i I. unfold induced. destruct (places_some seed 0 Leaf i) as [_ P]. simpl in P. rewrite P by assumption.
  set (v := nth i seed 0). destruct (heard_ok v) as [NH IN]; [apply B; apply nth_In; assumption|].
  assert (E : forall u j, get u (index_from seed 0 Leaf) = Some j -> j < length seed /\ u = nth j seed 0).
  { intros u j G. apply index_spec in G; [|assumption]. destruct G as [(k & K & -> & <-)|[_ G]]; [auto|].
    unfold get in G. rewrite find_leaf in G. discriminate. }
  destruct (pick_spec (index_from seed 0 Leaf) (heard v) NH) as [P1 P2].
  - intros u w j U W. apply E in U, W. destruct U as [_ ->], W as [_ ->]. reflexivity.
  - split; [assumption|]. intros j. rewrite P2. unfold induced_hears. fold v. split.
    + intros (u & U & G). apply E in G. destruct G as [J ->]. apply IN in U. rewrite U.
      apply Nat.ltb_lt in I, J. rewrite I, J. reflexivity.
    + intros Q. apply andb_true_iff in Q. destruct Q as [Q H]. apply andb_true_iff in Q. destruct Q as [_ J].
      apply Nat.ltb_lt in J. exists (nth j seed 0). split; [apply IN; assumption|]. rewrite index_some by assumption. reflexivity.
Qed.

Lemma map_nth_seq : forall l : list nat, map (fun i => nth i l 0) (seq 0 (length l)) = l.
Proof.
  intros l. induction l as [|a l IH]; [reflexivity|]. simpl. f_equal. rewrite <- seq_shift, map_map. exact IH.
Qed.

Lemma induced_no_pair : forall seed r s, no_pair (seq 0 (length seed)) (induced_hears seed h) r s -> no_pair seed h r s.
Proof.
  intros seed r s NP. rewrite <- (map_nth_seq seed) at 1. apply no_pair_map. revert NP. apply no_pair_ext. intros i j I J.
  apply in_seq in I, J. unfold induced_hears. destruct (Nat.ltb_spec i (length seed)); [|lia].
  destruct (Nat.ltb_spec j (length seed)); [reflexivity|lia].
Qed.

(* Each node of [order] is new and hears at least [least] nodes that are there; the number of all in the end. *)
Fixpoint grow (least : nat) (order : list nat) (there : table unit) (k : nat) : option nat :=
  match order with
  | [] => Some k
  | x :: rest =>
    if (x <? n) && negb (has there x) && (least <=? tally (has there) (heard x) 0)
    then grow least rest (set x tt there) (S k) else None
  end.
Definition grows (r s : nat) (seed order : list nat) : bool :=
  ascending seed && forallb (fun i => i <? n) seed && (s <=? length_of seed)
  && match grow (r + s - 1) order (set_of seed) (length_of seed) with Some k => k =? n | None => false end.

Lemma grow_sound : forall r s, 1 <= r -> forall order V there k, NoDup V -> (forall i, In i V -> i < n) ->
  (forall i, has there i = true <-> In i V) -> length V = k -> no_pair V h r s ->
  grow (r + s - 1) order there k = Some n -> no_pair (seq 0 n) h r s.
Proof.
  intros r s R order. induction order as [|x order IH]; intros V there k NV B T L NP G; simpl in G.
  - injection G as ->. apply (no_pair_same_nodes V); [assumption|apply seq_NoDup| |assumption]. intros i. split; intros I.
    + apply in_seq. specialize (B i I). lia.
    + apply (NoDup_length_incl NV (l' := seq 0 n)); [rewrite seq_length; lia| |assumption].
      intros j J. apply in_seq. specialize (B j J). lia.
  - destruct (_ && _) eqn:C in G; [|discriminate]. repeat (apply andb_true_iff in C; destruct C as [C ?]).
    apply Nat.ltb_lt in C. apply Nat.leb_le in H. apply negb_true_iff in H0.
    assert (NX : ~ In x V) by (intros Q; apply T in Q; congruence).
    apply (IH (x :: V) (set x tt there) (S k)); try assumption.
    + constructor; assumption.
    + intros i [<-|I]; auto.
    + intros i. rewrite has_set, orb_true_iff, T, Nat.eqb_eq. simpl. split; intros [Q|Q]; auto.
    + simpl. lia.
    + apply lemma_4; try assumption. rewrite tally_cnt, (heard_cnt n h heard h_range h_loop heard_ok) in H by assumption. simpl in H.
      apply Nat.le_trans with (1 := H).
      rewrite (cnt_incl V NV (seq 0 n) (h x) (seq_NoDup n 0)) by (intros v Q; apply in_seq; specialize (B v Q); lia).
      apply cnt_le. intros v _ Q. apply andb_true_iff in Q. destruct Q as [Q1 Q2]. rewrite Q1, andb_true_r.
      apply existsb_exists. exists v. split; [apply T; assumption|apply Nat.eqb_refl].
Qed.

Lemma grows_sound : forall r s seed order, 1 <= r -> grows r s seed order = true ->
  no_pair (seq 0 (length seed)) (induced_hears seed h) r s -> no_pair (seq 0 n) h r s.
Proof.
  intros r s seed order R G NP. unfold grows in G. repeat (apply andb_true_iff in G; destruct G as [G ?]).
  destruct (grow _ _ _ _) as [k|] eqn:E; [|discriminate]. apply Nat.eqb_eq in H. subst k.
  rewrite forallb_forall in H1.
  apply (grow_sound r s R order seed (set_of seed) (length_of seed)); try assumption.
  - apply ascending_nodup. assumption.
  - intros i I. apply Nat.ltb_lt. apply H1. assumption.
  - intros i. rewrite has_set_of, existsb_exists. split.
    + intros (u & U & Q). apply Nat.eqb_eq in Q. subst. assumption.
    + intros Q. exists i. split; [assumption|apply Nat.eqb_refl].
  - symmetry. apply length_of_is.
  - apply induced_no_pair. assumption.
Qed.

Lemma induced_range : forall seed i v, induced_hears seed h i v = true -> v < length seed.
Proof.
  intros seed i v Q. apply andb_true_iff in Q. destruct Q as [Q _]. apply andb_true_iff in Q. destruct Q as [_ Q].
  apply Nat.ltb_lt. assumption.
Qed.

Lemma induced_loop : forall seed i, induced_hears seed h i i = false.
Proof. intros. unfold induced_hears. rewrite h_loop. apply andb_false_r. Qed.

Lemma grows_seed : forall r s seed order, grows r s seed order = true -> NoDup seed /\ forall v, In v seed -> v < n.
Proof.
  intros r s seed order G. unfold grows in G. repeat (apply andb_true_iff in G; destruct G as [G ?]). rewrite forallb_forall in H1.
  split; [apply ascending_nodup; assumption|]. intros v V. apply Nat.ltb_lt. auto.
Qed.
End Graph.
