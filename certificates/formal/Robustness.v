(* Definition 1: (r,s)-robustness of finite digraphs. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting.
Import ListNotations.

(* The nodes are 0 .. nodes - 1; [hears G i j]: there is an arc from j to i, so that j is in N_i. *)
Record digraph := Digraph { nodes : nat; hears : nat -> nat -> bool }.

(* A set of nodes. What it says of numbers that are no nodes does not matter. *)
Definition set := nat -> bool.

(* The number of nodes in a set. *)
Definition size (G : digraph) (S : set) : nat := cnt (seq 0 (nodes G)) S.

(* X_S^r: the nodes i of S with at least r in-neighbours outside of S. *)
Definition reachable (G : digraph) (r : nat) (S : set) : set :=
  fun i => S i && (r <=? size G (fun j => hears G i j && negb (S j))).

Definition nonempty (G : digraph) (S : set) : Prop := exists i, i < nodes G /\ S i = true.
Definition disjoint (G : digraph) (S1 S2 : set) : Prop := forall i, i < nodes G -> S1 i = true -> S2 i = true -> False.
Definition same (G : digraph) (S1 S2 : set) : Prop := forall i, i < nodes G -> S1 i = S2 i.

(* Of any two nonempty disjoint sets of nodes, one is all r-reachable, or at least s nodes of both are.
   A digraph on one node has no such sets; by convention it is not 2-robust. *)
Definition robust (G : digraph) (r s : nat) : Prop :=
  (nodes G = 1 -> r <= 1) /\
  forall S1 S2 : set, nonempty G S1 -> nonempty G S2 -> disjoint G S1 S2 ->
    same G (reachable G r S1) S1 \/ same G (reachable G r S2) S2 \/
    s <= size G (reachable G r S1) + size G (reachable G r S2).
