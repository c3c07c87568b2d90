(* The checker: bytes in, a claim out; and its theorem. *)
From Coq Require Import List Bool Arith Lia String.
From Formal Require Import Counting Bytes Tables Refutation Robustness Evidence Checks Growth Canonical Reading Lemmas Separation Apart
  Tolerance.
Import ListNotations.
Local Open Scope string_scope.
Local Open Scope list_scope.
Local Open Scope nat_scope.

(* What a certificate can prove of a graph: that it is (r,s)-robust, or not; that sets hold it apart against f malicious
   nodes with two faces or one, bounded locally or in total, or that none do. *)
Inductive property := Robustness (yes : bool) (r s : nat) | Holding_apart (yes : bool) (f : nat) (two_faces local : bool).
Record claim := Claim { says : property; evidence : string; of_nodes : nat; of_arcs : nat }.

(* The claim is true of the graph G. *)
Definition holds (G : digraph) (c : claim) : Prop :=
  of_nodes c = nodes G /\
  match says c with
  | Robustness yes r s => if yes then robust G r s else ~ robust G r s
  | Holding_apart yes f two_faces local =>
    if yes then exists M S1 S2, apart G f two_faces local M S1 S2 else together G f two_faces local
  end.

Inductive outcome := Verified (c : claim) | Malformed (why : string) | Rejected (why : string) (place : nat).

(* The graph: n, and tables of in- and out-neighbours. *)
Record graph := Graph { order_of : nat; arc_list : list (nat * nat); in_table : table (list nat); out_table : table (list nat) }.

Fixpoint swapped (l found : list (nat * nat)) : list (nat * nat) :=
  match l with [] => found | (u, v) :: l' => swapped l' ((v, u) :: found) end.

Definition decode (b : bytes) : option graph :=
  match read_graph b with
  | Some (arcs, labels) =>
    let n := length_of labels in
    if labels_ok labels && arcs_ok n arcs && spelled b arcs labels
    then Some (Graph n arcs (gather arcs) (gather (swapped arcs [])))
    else None
  | None => None
  end.

(* Evidence that needs no other, of a graph or of a seed. None: it holds. *)
Definition direct (n : nat) (heard hearers : nat -> list nat) (r s : nat) (kind : json) (body : bytes) : option outcome :=
  if is_text "refutation" kind then
    if Nat.pow 10 4 <? n then Some (Malformed "a refutation is for graphs of at most 10000 nodes") else
    match refutes (question_of n heard hearers r s) body with
    | Refuted => None
    | Refused place => Some (Rejected "the refutation does not hold, at this byte of it:" place)
    end
  else if is_text "degree" kind then
    if 0 <? len body then Some (Malformed "evidence of kind degree has no body") else
    if degrees n heard r then None else Some (Rejected "the least in-degree is below floor(n/2) + r - 1 =" (n / 2 + r - 1))
  else Some (Malformed "there is no such kind of evidence for the verdict robust").

(* The body of a certificate: what follows the first newline, which the header may not reach beyond 2^26 bytes. *)
Fixpoint newline (fuel : nat) (b : bytes) (pos : nat) : option nat :=
  match fuel with
  | 0 => None
  | S f => if pos <? len b then if byte_at b pos =? 10 then Some pos else newline f b (S pos) else None
  end.
Definition part (b : bytes) (from to : nat) : bytes := Bytes (to - from) (fun i => byte_at b (from + i)).

Definition violation_keys := ["kind"; "S1"; "S2"].
Definition growth_keys := ["kind"; "seed"; "order"; "proof"].

(* The evidence of a claim about a graph that was decoded; r and s are in bounds. *)
Definition prove (g : graph) (robust_claim : bool) (r s : nat) (v : json) (body : bytes) : outcome :=
  let n := order_of g in
  let heard := at_place (in_table g) in
  let hearers := at_place (out_table g) in
  let kind := match v with JObj members => field "kind" members | _ => JNull end in
  let done name := Verified (Claim (Robustness robust_claim r s) name n (length_of (arc_list g))) in
  if robust_claim then
    if (n + 1) / 2 <? r then Rejected "no graph of this size is so robust: r is at most ceil(n/2) =" ((n + 1) / 2) else
    if is_text "growth" kind then
      match object_with growth_keys v with
      | None => Malformed "evidence of kind growth is an object with exactly the keys kind seed order proof"
      | Some members =>
        match ids n (field "seed" members), ids n (field "order" members), object_with ["kind"] (field "proof" members) with
        | Some seed, Some order, Some proof =>
          if grows n heard r s seed order then
            match direct (length_of seed) (induced seed heard) (induced seed hearers) r s (field "kind" proof) body with
            | None => done "growth"
            | Some other => other
            end
          else if ascending seed then Rejected "seed and order do not grow the graph" 0
          else Malformed "the seed is strictly ascending"
        | _, _, _ => Malformed "seed and order are lists of ids, and a proof has exactly the key kind"
        end
      end
    else
      match object_with ["kind"] v with
      | None => Malformed "evidence of this kind is none, or none that is checked here, or has other keys"
      | Some _ =>
        match direct n heard hearers r s kind body with
        | None => done (if is_text "degree" kind then "degree" else "refutation")
        | Some other => other
        end
      end
  else
    match object_with violation_keys v, is_text "violation" kind with
    | Some members, true =>
      match ids n (field "S1" members), ids n (field "S2" members) with
      | Some l1, Some l2 =>
        if negb (ascending l1 && ascending l2) then Malformed "S1 and S2 are strictly ascending" else
        if 0 <? len body then Malformed "evidence of kind violation has no body" else
        if violates n heard r s l1 l2 then done "violation" else Rejected "the pair does not violate the claimed robustness" 0
      | _, _ => Malformed "S1 and S2 are lists of ids"
      end
    | _, _ => Malformed "evidence for not-robust is an object with exactly the keys kind S1 S2, of kind violation"
    end.

(* The header and the body of a certificate. *)
Inductive opened := Opened (members : list (list nat * json)) (body : bytes) | Unreadable (why : string).
Definition open_certificate (c : bytes) : opened :=
  if Nat.pow 2 30 <? len c then Unreadable "a certificate has at most 2^30 bytes" else
  match newline (Nat.pow 2 26) c 0 with
  | None => Unreadable "a certificate begins with one line of JSON"
  | Some at_ =>
    match read_json (part c 0 at_) with
    | None => Unreadable "the first line of a certificate is JSON in UTF-8"
    | Some header =>
      match object_with ["format"; "graph"; "claim"; "evidence"] header with
      | None => Unreadable "a certificate is an object with exactly the keys format graph claim evidence"
      | Some members => Opened members (part c (S at_) (len c))
      end
    end
  end.

(* [digest]: the SHA-256 of the graph in hexadecimal, which binds a certificate to it. *)
Definition about (digest : list nat) (members : list (list nat * json)) : bool :=
  match field "graph" members with JStr codes => same_codes codes digest | _ => false end.

(* A certificate of robustness. *)
Definition ordinary_format : string := "robustness/certificate/1".
Definition ordinary (digest : list nat) (g : graph) (members : list (list nat * json)) (body : bytes) : outcome :=
  if negb (is_text ordinary_format (field "format" members)) then
    Malformed "the format of a certificate in this place is robustness/certificate/1" else
  match object_with ["property"; "r"; "s"; "verdict"] (field "claim" members) with
  | None => Malformed "a claim is an object with exactly the keys property r s verdict"
  | Some asked =>
    if negb (about digest members) then Rejected "the certificate is about another graph" 0 else
    if negb (is_text "rs-robust" (field "property" asked)) then Malformed "the property is rs-robust" else
    match natural (field "r" asked), natural (field "s" asked) with
    | Some r, Some s =>
      if (1 <=? r) && (r <=? Nat.pow 2 31) && (1 <=? s) && (s <=? order_of g) then
        if is_text "robust" (field "verdict" asked) then prove g true r s (field "evidence" members) body else
        if is_text "not-robust" (field "verdict" asked) then prove g false r s (field "evidence" members) body else
        Malformed "a verdict is robust or not-robust"
      else Malformed "r is in 1..2^31 and s in 1..n"
    | _, _ => Malformed "r and s are integers"
    end
  end.

(* A certificate of what f malicious nodes can do: the claim, and the proof. *)
Definition first_tolerance_format : string := "robustness/tolerance-certificate/1".
Definition second_tolerance_format : string := "robustness/tolerance-certificate/2".
Definition two_ways (yes no : string) (v : json) : option bool :=
  if is_text yes v then Some true else if is_text no v then Some false else None.
Definition separates (digest : list nat) (g : graph) (second yes : bool) (f : nat) (two_faces local : bool) (v : json)
  (body : bytes) : outcome :=
  let n := order_of g in
  let heard := at_place (in_table g) in
  let hearers := at_place (out_table g) in
  let kind := match v with JObj members => field "kind" members | _ => JNull end in
  let done name := Verified (Claim (Holding_apart yes f two_faces local) name n (length_of (arc_list g))) in
  if yes then
    match object_with ["kind"; "M"; "S1"; "S2"] v, is_text "sets" kind with
    | Some members, true =>
      match ids n (field "M" members), ids n (field "S1" members), ids n (field "S2" members) with
      | Some m, Some l1, Some l2 =>
        if negb (ascending m && ascending l1 && ascending l2) then Malformed "M, S1 and S2 are strictly ascending" else
        if negb (holds_apart n heard f two_faces local m l1 l2) then Rejected "the sets do not hold the network apart" 0 else
        if 0 <? len body then Malformed "evidence of kind sets has no body" else done "sets"
      | _, _, _ => Malformed "M, S1 and S2 are lists of ids"
      end
    | _, _ => Malformed "evidence for apart is an object with exactly the keys kind M S1 S2, of kind sets"
    end
  else
    match object_with ["kind"] v with
    | None => Malformed "evidence of this kind is none, or none that is checked here, or has other keys"
    | Some _ =>
      if is_text "robust" kind then
        match open_certificate body with
        | Unreadable why => Malformed why
        | Opened inner rest =>
          match ordinary digest g inner rest with
          | Verified c =>
            match says c with
            | Robustness true r s => if (r =? 2 * f + 1) && (s =? 1) then done "robust"
                                     else Rejected "the ordinary certificate proves another claim than robustness of 2f + 1 =" (2 * f + 1)
            | _ => Rejected "the ordinary certificate proves another claim than robustness of 2f + 1 =" (2 * f + 1)
            end
          | other => other
          end
        end
      else if is_text "refutation" kind && second then
        if Nat.pow 10 4 <? n then Malformed "a refutation is for graphs of at most 10000 nodes" else
        match keeps_together (threat_of n heard hearers f two_faces local) body with
        | Refuted => done "refutation"
        | Refused place => Rejected "the refutation does not hold, at this byte of it:" place
        end
      else Malformed "there is no such kind of evidence for the verdict together that is checked here"
    end.
Definition tolerance (digest : list nat) (g : graph) (second : bool) (members : list (list nat * json)) (body : bytes) : outcome :=
  match object_with ["f"; "faces"; "bound"; "verdict"] (field "claim" members) with
  | None => Malformed "a claim is an object with exactly the keys f faces bound verdict"
  | Some asked =>
    match natural (field "f" asked), natural (field "faces" asked), two_ways "local" "total" (field "bound" asked),
          two_ways "apart" "together" (field "verdict" asked) with
    | Some f, Some faces, Some local, Some yes =>
      if negb ((f <=? Nat.pow 2 31) && ((faces =? 1) || (faces =? 2))) then Malformed "f is in 0..2^31, and faces is 1 or 2" else
      if negb (about digest members) then Rejected "the certificate is about another graph" 0 else
      separates digest g second yes f (faces =? 2) local (field "evidence" members) body
    | _, _, _, _ => Malformed "f and faces are integers, a bound is total or local, a verdict apart or together"
    end
  end.

(* The graph [g], a certificate [c] of any of these kinds. *)
Definition verify (digest : list nat) (g c : bytes) : outcome :=
  match open_certificate c with
  | Unreadable why => Malformed why
  | Opened members body =>
    if Nat.pow 2 28 <? len g then Malformed "a graph has at most 2^28 bytes" else
    match decode g with
    | None => Malformed "the graph is not in canonical bytes"
    | Some decoded =>
      let format := field "format" members in
      if is_text first_tolerance_format format then tolerance digest decoded false members body else
      if is_text second_tolerance_format format then tolerance digest decoded true members body else
      if is_text ordinary_format format then ordinary digest decoded members body else
      Malformed "the formats that are checked here are robustness/certificate/1 and robustness/tolerance-certificate/1 and /2"
    end
  end.

Lemma decode_describes : forall b g, decode b = Some g ->
  describes b (graph_of (order_of g) (arc_list g)) /\ arcs_ok (order_of g) (arc_list g) = true /\
  in_table g = gather (arc_list g).
Proof.
  intros b g D. unfold decode in D. destruct (read_graph b) as [[arcs labels]|]; [|discriminate].
  cbv zeta in D. rewrite length_of_is in D.
  destruct (_ && _) eqn:E in D; [|discriminate]. injection D as <-. simpl. apply andb_true_iff in E. destruct E as [E S].
  apply andb_true_iff in E. destruct E as [L A]. split; [|auto]. exists arcs, labels. split; [assumption|].
  split; [assumption|]. split; [apply spelled_sound; assumption|reflexivity].
Qed.

Section Graph.
Variable n : nat.
Variable arcs : list (nat * nat).
Hypothesis arcs_fine : arcs_ok n arcs = true.
Let h := hears (graph_of n arcs).

Lemma h_range : forall i v, h i v = true -> v < n.
Proof. intros i v H. apply graph_hears in H. apply (arcs_ok_in n arcs v i arcs_fine) in H. tauto. Qed.
Lemma h_loop : forall i, h i i = false.
Proof.
  intros i. apply not_true_is_false. intros H. apply graph_hears in H. apply (arcs_ok_in n arcs i i arcs_fine) in H. tauto.
Qed.
Lemma heard_fine : lists n h (at_place (gather arcs)).
Proof.
  intros i _. destruct (gather_spec arcs (arcs_ok_nodup n arcs arcs_fine) i) as [N E]. split; [assumption|].
  intros u. rewrite E. symmetry. apply graph_hears.
Qed.
End Graph.

Lemma direct_sound : forall n h heard hearers r s kind body, (forall i v, h i v = true -> v < n) -> (forall i, h i i = false) ->
  lists n h heard -> 1 <= r -> 1 <= s -> direct n heard hearers r s kind body = None -> no_pair (seq 0 n) h r s.
Proof.
  intros n h heard hearers r s kind body HR HL HO R S D. unfold direct in D. destruct (is_text "refutation" kind).
  - destruct (_ <? n); [discriminate|]. destruct (refutes _ body) eqn:E; [|discriminate].
    eapply refutation_sound; eassumption.
  - destruct (is_text "degree" kind); [|discriminate]. destruct (0 <? len body); [discriminate|].
    destruct (degrees n heard r) eqn:E; [|discriminate]. eapply degrees_sound; eassumption.
Qed.

Lemma direct_proves_nothing_else : forall n heard hearers r s kind body c,
  direct n heard hearers r s kind body = Some (Verified c) -> False.
Proof.
  intros n heard hearers r s kind body c D. unfold direct in D.
  destruct (is_text "refutation" kind); [destruct (_ <? n); [discriminate|]; destruct (refutes _ body); discriminate|].
  destruct (is_text "degree" kind); [|discriminate]. destruct (0 <? len body); [discriminate|].
  destruct (degrees n heard r); discriminate.
Qed.

Lemma prove_sound : forall g rc r s v body c, arcs_ok (order_of g) (arc_list g) = true -> in_table g = gather (arc_list g) ->
  1 <= r -> 1 <= s -> prove g rc r s v body = Verified c -> holds (graph_of (order_of g) (arc_list g)) c.
Proof.
  intros g rc r s v body c A T R S P. unfold prove in P. cbv zeta in P. rewrite T in P.
  set (n := order_of g) in *. set (arcs := arc_list g) in *. set (G := graph_of n arcs).
  pose proof (h_range n arcs A) as HR. pose proof (h_loop n arcs A) as HL. pose proof (heard_fine n arcs A) as HO.
  set (kind := match v with JObj members => field "kind" members | _ => JNull end) in *.
  destruct rc.
  - destruct (Nat.ltb_spec ((n + 1) / 2) r) as [|B]; [discriminate|].
    assert (ONE : n = 1 -> r <= 1) by (intros E; rewrite E in B; exact B).
    enough (forall name, no_pair (seq 0 n) (hears G) r s -> Verified (Claim (Robustness true r s) name n (length_of arcs)) = Verified c -> holds G c) as DONE.
    + destruct (is_text "growth" kind).
      * destruct (object_with growth_keys v) as [members|]; [|discriminate].
        destruct (ids n (field "seed" members)) as [seed|]; [|discriminate].
        destruct (ids n (field "order" members)) as [order|]; [|discriminate].
        destruct (object_with ["kind"] (field "proof" members)) as [proof|]; [|discriminate].
        destruct (grows n _ r s seed order) eqn:GR; [|destruct (ascending seed); discriminate].
        rewrite (length_of_is _ seed) in P. destruct (direct _ _ _ r s _ body) eqn:D; [subst; apply direct_proves_nothing_else in D; contradiction|].
        apply (DONE "growth"); [|assumption]. destruct (grows_seed _ _ _ _ _ _ GR) as [SN SB].
        eapply grows_sound; try eassumption. eapply direct_sound; try eassumption.
        -- apply induced_range.
        -- apply induced_loop. assumption.
        -- eapply induced_ok; eassumption.
      * destruct (object_with ["kind"] v); [|discriminate]. destruct (direct _ _ _ r s kind body) eqn:D; [subst; apply direct_proves_nothing_else in D; contradiction|].
        eapply DONE; [|eassumption]. eapply direct_sound; eassumption.
    + intros name NP E. injection E as <-. split; [reflexivity|]. apply no_pair_robust; assumption.
  - destruct (object_with violation_keys v) as [members|]; [|discriminate]. destruct (is_text "violation" kind); [|discriminate].
    destruct (ids n (field "S1" members)) as [l1|]; [|discriminate]. destruct (ids n (field "S2" members)) as [l2|]; [|discriminate].
    destruct (negb _); [discriminate|]. destruct (0 <? len body); [discriminate|].
    destruct (violates n _ r s l1 l2) eqn:V; [|discriminate]. injection P as <-. split; [reflexivity|].
    exact (violates_sound n (hears G) _ HR HL HO r s l1 l2 V).
Qed.

Lemma ordinary_sound : forall digest g members body c, arcs_ok (order_of g) (arc_list g) = true -> in_table g = gather (arc_list g) ->
  ordinary digest g members body = Verified c -> holds (graph_of (order_of g) (arc_list g)) c.
Proof.
  intros digest g members body c A T V. unfold ordinary in V. destruct (negb _); [discriminate|].
  destruct (object_with _ (field "claim" members)) as [asked|]; [|discriminate].
  destruct (negb _); [discriminate|]. destruct (negb _); [discriminate|].
  destruct (natural (field "r" asked)) as [r|]; [|discriminate]. destruct (natural (field "s" asked)) as [s|]; [|discriminate].
  destruct (_ && _) eqn:B in V; [|discriminate]. repeat (apply andb_true_iff in B; destruct B as [B ?]).
  apply Nat.leb_le in B, H0.
  destruct (is_text "robust" _); [exact (prove_sound _ _ _ _ _ _ _ A T B H0 V)|].
  destruct (is_text "not-robust" _); [exact (prove_sound _ _ _ _ _ _ _ A T B H0 V)|discriminate].
Qed.

Lemma separates_sound : forall digest g second yes f two_faces local v body c, arcs_ok (order_of g) (arc_list g) = true ->
  in_table g = gather (arc_list g) -> separates digest g second yes f two_faces local v body = Verified c ->
  holds (graph_of (order_of g) (arc_list g)) c.
Proof.
  intros digest g second yes f two_faces local v body c A T P. unfold separates in P. cbv zeta in P. rewrite T in P.
  set (n := order_of g) in *. set (arcs := arc_list g) in *.
  pose proof (h_range n arcs A) as HR. pose proof (h_loop n arcs A) as HL. pose proof (heard_fine n arcs A) as HO.
  set (kind := match v with JObj members => field "kind" members | _ => JNull end) in *. destruct yes.
  - destruct (object_with _ v) as [members|]; [|discriminate]. destruct (is_text "sets" kind); [|discriminate].
    destruct (ids n (field "M" members)) as [m|]; [|discriminate]. destruct (ids n (field "S1" members)) as [l1|]; [|discriminate].
    destruct (ids n (field "S2" members)) as [l2|]; [|discriminate]. destruct (negb _); [discriminate|].
    destruct (negb _) eqn:H in P; [discriminate|]. apply negb_false_iff in H. destruct (0 <? len body); [discriminate|].
    injection P as <-. split; [reflexivity|]. cbn [says].
    exists (has (set_of m)), (has (set_of l1)), (has (set_of l2)).
    exact (holds_apart_sound n (hears (graph_of n arcs)) _ HR HL HO f two_faces local m l1 l2 H).
  - destruct (object_with ["kind"] v); [|discriminate]. destruct (is_text "robust" kind).
    + destruct (open_certificate body) as [inner rest|]; [|discriminate].
      destruct (ordinary digest g inner rest) as [c'| |] eqn:O; [|discriminate|discriminate].
      pose proof (ordinary_sound digest g inner rest c' A T O) as [_ H].
      destruct (says c') as [[|] r s|]; [|discriminate|discriminate]. destruct (_ && _) eqn:E in P; [|discriminate].
      apply andb_true_iff in E. destruct E as [E1 E2]. apply Nat.eqb_eq in E1, E2. subst r s. injection P as <-.
      split; [reflexivity|]. cbn [says]. exact (robust_together n (hears (graph_of n arcs)) f two_faces local (robust_no_pair _ _ _ H)).
    + destruct (_ && second); [|discriminate]. destruct (_ <? n); [discriminate|].
      destruct (keeps_together _ body) eqn:K; [|discriminate]. injection P as <-. split; [reflexivity|]. cbn [says].
      exact (refuted_together n (hears (graph_of n arcs)) _ HR HL HO _ f two_faces local body K).
Qed.

(* The main theorem: whatever the bytes, a claim that is verified is true of the graph whose canonical bytes they are. *)
Theorem verify_sound : forall (digest : list nat) (graph_bytes certificate_bytes : bytes) (c : claim),
  verify digest graph_bytes certificate_bytes = Verified c ->
  exists G : digraph, describes graph_bytes G /\ holds G c.
Proof.
  intros digest g b c V. unfold verify in V. destruct (open_certificate b) as [members body|]; [|discriminate].
  destruct (_ <? len g); [discriminate|].
  destruct (decode g) as [decoded|] eqn:D; [|discriminate]. apply decode_describes in D. destruct D as (D1 & D2 & D3).
  exists (graph_of (order_of decoded) (arc_list decoded)). split; [assumption|]. cbv zeta in V.
  assert (TO : forall second, tolerance digest decoded second members body = Verified c -> holds (graph_of (order_of decoded) (arc_list decoded)) c).
  { intros second Q. unfold tolerance in Q. destruct (object_with _ (field "claim" members)) as [asked|]; [|discriminate].
    destruct (natural (field "f" asked)) as [f|]; [|discriminate]. destruct (natural (field "faces" asked)) as [faces|]; [|discriminate].
    destruct (two_ways "local" "total" _) as [local|]; [|discriminate]. destruct (two_ways "apart" "together" _) as [yes|]; [|discriminate].
    destruct (negb _); [discriminate|]. destruct (negb _); [discriminate|]. exact (separates_sound _ _ _ _ _ _ _ _ _ _ D2 D3 Q). }
  destruct (is_text first_tolerance_format _); [exact (TO _ V)|]. destruct (is_text second_tolerance_format _); [exact (TO _ V)|].
  destruct (is_text ordinary_format _); [exact (ordinary_sound _ _ _ _ _ D2 D3 V)|discriminate].
Qed.
