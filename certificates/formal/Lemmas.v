(* Lemmas that the toolkit leans on elsewhere, by their names in the documentation. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness.
Import ListNotations.

(* Lemma 1 (i): a smaller s asks for less. *)
Theorem lemma_1_i : forall G r s s', s' <= s -> robust G r s -> robust G r s'.
Proof.
  intros G r s s' L [ONE R]. split; [assumption|]. intros S1 S2 N1 N2 D.
  destruct (R S1 S2 N1 N2 D) as [Q|[Q|Q]]; auto. right. right. lia.
Qed.
