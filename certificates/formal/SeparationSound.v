(* A graph with an accepted refutation has no sets that hold it apart. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Bytes Sets Tables Rules Soundness Refutation Roles RolesSound RolesCount Separation.
Import ListNotations.

Section Threat.
Variable n : nat.
Variable h : nat -> nat -> bool.
Variable needs : nat -> nat.
Variable t : threat.
Hypothesis OK : sound_threat n h needs t.

Notation solution := (solution n h needs t).
Notation row_ok := (row_ok n h needs).
Notation two := (two_faces t).

Lemma swap : forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> solution N2 N1 M2 M1.
Proof. intros. apply solution_swap. assumption. Qed.

Lemma hark_here_sound : forall N1 N2 M1 M2 s last, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
  match hark_here t s last with Some u => suits N1 N2 M1 M2 u | None => False end.
Proof.
  intros N1 N2 M1 M2 s last S ST. unfold hark_here. cbv zeta.
  pose proof (hark_sound n h needs t OK N1 N2 M1 M2 s S ST (groups (asks t))
                (worth_it t (here s) (bad s) (left_total t (bad s)) last) (pP (here s)) (pF (here s)) (groups_ok _ _ _ _ OK)) as W.
  destruct ST as [[A1 A2 A3 A4] B C]. specialize (W (conj A1 A3)).
  destruct (hark _ _ _ _ _ _ _ _ _ _) as [[P F]|]; [|assumption]. destruct W as [W1 W2]. split; [split|exact B|exact C]; cbn; auto.
Qed.

Lemma budget_now_sound : forall N1 N2 M1 M2 s m, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
  match budget_now t s m with Some u => suits N1 N2 M1 M2 u | None => False end.
Proof.
  intros N1 N2 M1 M2 s m S ST. unfold budget_now. pose proof (budget_sound n h needs t OK N1 N2 M1 M2 s S ST) as B.
  destruct (of_budget m) as [[Z maybe]|]; [|assumption]. destruct (_ && _); assumption.
Qed.

Lemma settle_roles_sound : forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> forall fuel s m, suits N1 N2 M1 M2 s ->
  match settle_roles fuel t s m with Empty => False | Rest u _ => suits N1 N2 M1 M2 u | Endless => True end.
Proof.
  intros N1 N2 M1 M2 S fuel. induction fuel as [|fuel IH]; intros s m ST; [exact I|]. cbn [settle_roles]. cbv zeta.
  pose proof (role_keeps n h needs t (rounds (asks t)) N1 N2 M1 M2 s S ST) as S1. set (s1 := role _ _ s) in *.
  rewrite (possible n h needs t N1 N2 M1 M2 s1 S S1).
  pose proof (budget_now_sound N1 N2 M1 M2 s1 m S S1) as S2.
  destruct (budget_now t s1 m) as [s2|]; [|assumption]. destruct (negb (equal_roles s1 s2)); [apply IH; assumption|].
  pose proof (hark_here_sound N1 N2 M1 M2 s2 (of_here m) S S2) as S3. destruct (hark_here t s2 (of_here m)) as [s3|]; [|assumption].
  pose proof (hark_here_sound N2 N1 M2 M1 (flip s3) (of_there m) (swap _ _ _ _ S) (suits_flip _ _ _ _ _ S3)) as S4.
  destruct (hark_here t (flip s3) (of_there m)) as [s4|]; [|assumption].
  destruct (negb (equal_roles s2 (flip s4))); [apply IH; apply suits_flip; assumption|].
  rewrite (shares_sound n h needs t OK N1 N2 M1 M2 s2 S S2). assumption.
Qed.

Lemma node_fine : forall body pos x pos', node (asks t) body pos = Some (x, pos') -> row_ok x.
Proof.
  intros body pos x pos' N. unfold node in N. destruct (number _ _ _ _ _ _) as [[v p]|]; [|discriminate].
  destruct (row_of (asks t) v) as [y|] eqn:R; [|discriminate]. destruct (id y =? v); [|discriminate].
  injection N as <- <-. apply (row_of_ok _ _ _ _ OK) with (v := v). assumption.
Qed.

(* Taking a node that is not normal from P. *)
Lemma drop_normal : forall N1 N2 M1 M2 s x, suits N1 N2 M1 M2 s -> row_ok x -> N1 (id x) = false ->
  suits N1 N2 M1 M2 (Roles (Part (diff (pP (here s)) (self x)) (pQ (here s)) (pF (here s)) (pT (here s))) (there s) (bad s)).
Proof.
  intros N1 N2 M1 M2 s x [[A1 A2 A3 A4] B C] O U. split; [split|exact B|exact C]; cbn; auto. intros v V.
  rewrite mem_diff, (A1 v V). simpl. apply negb_true_iff. destruct (mem (self x) v) eqn:W; [|reflexivity].
  apply (ok_self _ _ _ _ O) in W. subst. congruence.
Qed.

Lemma exclude_here_sound : forall N1 N2 M1 M2 body pos s, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
  match exclude_here t body pos s with
  | Some (_, Some u) => suits N1 N2 M1 M2 u | Some (_, None) => False | None => True end.
Proof.
  intros N1 N2 M1 M2 body pos s S ST. unfold exclude_here.
  destruct (node (asks t) body pos) as [[x p1]|] eqn:NX; [|exact I]. apply node_fine in NX.
  destruct (node (asks t) body p1) as [[y p2]|] eqn:NY; [|exact I]. apply node_fine in NY. cbv zeta.
  destruct (_ && crowds_out t s x y) eqn:E; [|exact I]. apply andb_true_iff in E. destruct E as [E CO].
  apply andb_true_iff in E. destruct E as [_ TY]. apply (on_T _ _ _ (on_there _ _ _ _ _ ST)) in TY.
  assert (NN : N1 (id x) = false).
  { apply not_true_is_false. intros N. exact (crowds_out_sound n h needs t OK N1 N2 M1 M2 s x y S ST NX NY N TY CO). }
  destruct (mem (pT (here s)) (id x)) eqn:TX.
  - apply (on_T _ _ _ (on_here _ _ _ _ _ ST)) in TX. congruence.
  - apply drop_normal; assumption.
Qed.

Lemma count_roles_sound : forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> forall body fuel pos s m run, suits N1 N2 M1 M2 s ->
  match count_roles fuel t body pos s m run with
  | ClosedAt _ => False | OpenAt _ u _ => suits N1 N2 M1 M2 u | WrongAt _ => True end.
Proof.
  intros N1 N2 M1 M2 S body fuel. induction fuel as [|fuel IH]; intros pos s m run ST; [exact I|]. cbn [count_roles]. cbv zeta.
  destruct (next body pos =? 6).
  - pose proof (exclude_here_sound N1 N2 M1 M2 body (Datatypes.S pos) s S ST) as E.
    destruct (exclude_here _ _ _ _) as [[p [u|]]|]; [|contradiction|exact I]. apply IH. assumption.
  - destruct (next body pos =? 7).
    + pose proof (exclude_here_sound N2 N1 M2 M1 body (Datatypes.S pos) (flip s) (swap _ _ _ _ S) (suits_flip _ _ _ _ _ ST)) as E.
      destruct (exclude_here _ _ _ _) as [[p [u|]]|]; [|contradiction|exact I]. apply IH. apply suits_flip. assumption.
    + destruct run; [|assumption]. destruct (next body pos =? 0); [|exact I].
      pose proof (settle_roles_sound N1 N2 M1 M2 S (rounds (asks t)) s m ST) as E. unfold settle_all.
      destruct (settle_roles _ _ _ _); [assumption|apply IH; assumption|exact I].
Qed.

Definition nothing (s : roles) : Prop := forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> False.

Lemma nothing_flip : forall s, nothing s -> nothing (flip s).
Proof.
  intros s NO N1 N2 M1 M2 S ST. apply (NO N2 N1 M2 M1); [apply swap; assumption|]. apply suits_flip in ST. destruct s. exact ST.
Qed.

Lemma normal_branch_sound : forall N1 N2 M1 M2 s x yes no, suits N1 N2 M1 M2 s -> row_ok x -> normal_branch s x = Some (yes, no) ->
  if N1 (id x) then suits N1 N2 M1 M2 yes else suits N1 N2 M1 M2 no.
Proof.
  intros N1 N2 M1 M2 s x yes no ST O B. unfold normal_branch in B. cbv zeta in B. destruct (_ && _); [|discriminate].
  injection B as <- <-. destruct (N1 (id x)) eqn:N; [|apply drop_normal; assumption].
  destruct ST as [[A1 A2 A3 A4] B C]. split; [split|exact B|exact C]; cbn; auto. intros v V. rewrite mem_union in V.
  apply orb_true_iff in V. destruct V as [V|V]; [auto|]. apply (ok_self _ _ _ _ O) in V. subst. assumption.
Qed.

Lemma bad_branch_sound : forall N1 N2 M1 M2 s x yes no, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s -> row_ok x ->
  bad_branch two s x = Some (yes, no) -> if M1 (id x) then suits N1 N2 M1 M2 yes else suits N1 N2 M1 M2 no.
Proof.
  intros N1 N2 M1 M2 s x yes no S ST O B. unfold bad_branch in B. cbv zeta in B. destruct (_ && _); [|discriminate].
  injection B as <- <-. pose proof (of_faces _ _ _ _ _ _ _ _ S) as OF. destruct ST as [[A1 A2 A3 A4] [B1 B2 B3 B4] C].
  destruct (M1 (id x)) eqn:MX.
  - split; [split|split|]; cbn; auto; intros v V; rewrite mem_union in V; apply orb_true_iff in V; (destruct V as [V|V]; [auto|]);
      apply (ok_self _ _ _ _ O) in V; subst; rewrite MX; [apply orb_true_r|reflexivity].
  - assert (D : forall (M : nat -> bool) v, M (id x) = false -> M v = true -> mem (self x) v = false).
    { intros M v E V. destruct (mem (self x) v) eqn:W; [|reflexivity]. apply (ok_self _ _ _ _ O) in W. subst. congruence. }
    destruct two.
    + split; [split|split|]; cbn; auto; intros v V; rewrite mem_diff.
      * rewrite (A2 v V), (D M1 v MX V). reflexivity.
      * rewrite OF in MX. rewrite (B2 v V), (D M2 v MX V). reflexivity.
    + split; [split|split|]; cbn; auto; intros v V; rewrite mem_diff. rewrite (A2 v V), (D M1 v MX V). reflexivity.
Qed.

Lemma equal_parts_eq : forall a b, equal_parts a b = true -> a = b.
Proof.
  intros [] [] E. unfold equal_parts in E. simpl in E. repeat (apply andb_true_iff in E; destruct E as [E ?]).
  f_equal; apply equal_eq; assumption.
Qed.

Lemma flip_both_some : forall r yes no, flip_both r = Some (yes, no) -> exists y z, r = Some (y, z) /\ yes = flip y /\ no = flip z.
Proof. intros [[y z]|] yes no E; [|discriminate]. injection E as <- <-. eauto. Qed.

Lemma branch_roles_sound : forall op s x symmetric yes no, row_ok x -> branch_roles two op s x symmetric = Some (yes, no) ->
  nothing yes -> nothing no -> nothing s.
Proof.
  intros op s x symmetric yes no O B HY HN N1 N2 M1 M2 S ST.
  destruct op as [|[|[|[|[|[|op]]]]]]; cbn [branch_roles] in B; try discriminate.
  - destruct symmetric; [|discriminate]. destruct (equal_parts (here s) (there s)) eqn:E; [|discriminate]. simpl in B.
    apply equal_parts_eq in E. destruct (normal_branch s x) as [[y z]|] eqn:NB; [|discriminate]. injection B as <- <-.
    assert (FL : flip s = s) by (destruct s; simpl in E; subst; reflexivity).
    pose proof (normal_branch_sound N1 N2 M1 M2 s x y z ST O NB) as W1.
    pose proof (suits_flip _ _ _ _ _ ST) as ST'. rewrite FL in ST'.
    pose proof (normal_branch_sound N2 N1 M2 M1 s x y z ST' O NB) as W2.
    destruct (N1 (id x)); [exact (HY _ _ _ _ S W1)|]. destruct (N2 (id x)); [exact (HY _ _ _ _ (swap _ _ _ _ S) W2)|].
    apply (HN N1 N2 M1 M2 S). split; cbn; [apply W1|apply W2|apply ST].
  - pose proof (normal_branch_sound N1 N2 M1 M2 s x yes no ST O B) as W. destruct (N1 (id x)); [exact (HY _ _ _ _ S W)|exact (HN _ _ _ _ S W)].
  - apply flip_both_some in B. destruct B as (y & z & B & -> & ->).
    pose proof (normal_branch_sound N2 N1 M2 M1 (flip s) x y z (suits_flip _ _ _ _ _ ST) O B) as W.
    destruct (N2 (id x)); [apply (HY _ _ _ _ S)|apply (HN _ _ _ _ S)]; apply suits_flip; assumption.
  - pose proof (bad_branch_sound N1 N2 M1 M2 s x yes no S ST O B) as W. destruct (M1 (id x)); [exact (HY _ _ _ _ S W)|exact (HN _ _ _ _ S W)].
  - apply flip_both_some in B. destruct B as (y & z & B & -> & ->).
    pose proof (bad_branch_sound N2 N1 M2 M1 (flip s) x y z (swap _ _ _ _ S) (suits_flip _ _ _ _ _ ST) O B) as W.
    destruct (M2 (id x)); [apply (HY _ _ _ _ S)|apply (HN _ _ _ _ S)]; apply suits_flip; assumption.
Qed.

Lemma walk_roles_sound : forall body fuel pos s m symmetric waiting, walk_roles fuel t body pos s m symmetric waiting = Refuted ->
  nothing s /\ Forall (fun w => nothing (fst (fst w))) waiting.
Proof.
  intros body fuel. induction fuel as [|fuel IH]; intros pos s m symmetric waiting W; [discriminate|]. cbn [walk_roles] in W. cbv zeta in W.
  assert (CL : forall pos', match waiting with
      | [] => if pos' =? len body then Refuted else Refused pos'
      | (s', m', symmetric') :: rest => walk_roles fuel t body pos' s' m' symmetric' rest end = Refuted ->
      Forall (fun w => nothing (fst (fst w))) waiting).
  { intros pos' Q. destruct waiting as [|[[s' m'] y'] rest]; [constructor|]. apply IH in Q. constructor; tauto. }
  assert (SS : forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
    match settle_all t s m with Empty => False | Rest u _ => suits N1 N2 M1 M2 u | Endless => True end)
    by (intros N1 N2 M1 M2 S ST; apply settle_roles_sound; assumption).
  destruct (settle_all t s m) as [|s1 m1|]; [| |discriminate].
  { split; [|eauto]. intros N1 N2 M1 M2 S ST. exact (SS N1 N2 M1 M2 S ST). }
  assert (CS : forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> suits N1 N2 M1 M2 s ->
    match count_roles (S (len body)) t body pos s1 m1 false with ClosedAt _ => False | OpenAt _ u _ => suits N1 N2 M1 M2 u | WrongAt _ => True end)
    by (intros N1 N2 M1 M2 S ST; apply count_roles_sound; [assumption|exact (SS N1 N2 M1 M2 S ST)]).
  destruct (count_roles _ _ _ _ _ _ _) as [p|p s2 m2|p]; [| |discriminate].
  { split; [|eauto]. intros N1 N2 M1 M2 S ST. exact (CS N1 N2 M1 M2 S ST). }
  destruct (node (asks t) body (S p)) as [[x p2]|] eqn:N; [|discriminate]. apply node_fine in N.
  destruct (branch_roles _ _ s2 x symmetric) as [[yes no]|] eqn:B; [|discriminate].
  apply IH in W. destruct W as [W1 W2]. inversion W2 as [|? ? W3 W4]; subst. simpl in W3. split; [|assumption].
  intros N1 N2 M1 M2 S ST. exact (branch_roles_sound _ _ _ _ _ _ N B W1 W3 N1 N2 M1 M2 S (CS N1 N2 M1 M2 S ST)).
Qed.

Theorem keeps_together_sound : forall body, keeps_together t body = Refuted -> forall N1 N2 M1 M2, solution N1 N2 M1 M2 -> False.
Proof.
  intros body R N1 N2 M1 M2 S. unfold keeps_together in R. cbv zeta in R. apply walk_roles_sound in R. destruct R as [R _].
  assert (NO : forall v, mem (diff (full (asks t)) (full (asks t))) v = true -> False).
  { intros v V. rewrite mem_diff in V. apply andb_true_iff in V. destruct V as [V W]. rewrite V in W. discriminate. }
  assert (ALL : forall v, v < n -> mem (full (asks t)) v = true) by (intros v V; rewrite (full_ok _ _ _ _ OK); apply Nat.ltb_lt; assumption).
  apply (R N1 N2 M1 M2 S). split; [split|split|]; cbn; intros v V; try destruct (NO v V); apply ALL.
  - exact (in_N1 _ _ _ _ _ _ _ _ S v V).
  - exact (in_M1 _ _ _ _ _ _ _ _ S v V).
  - exact (in_N2 _ _ _ _ _ _ _ _ S v V).
  - exact (in_M2 _ _ _ _ _ _ _ _ S v V).
Qed.
End Threat.
