(* Sets that hold a network apart: a trap is one of two faces, a violation one of one face. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Robustness.
Import ListNotations.

(* The bound on M: at most f nodes in total; or, locally, nobody outside of M hears more than f nodes of M. *)
Definition obeys (G : digraph) (f : nat) (local : bool) (M : set) : Prop :=
  if local then forall i, i < nodes G -> M i = false -> size G (fun j => hears G i j && M j) <= f
  else size G M <= f.

(* Disjoint S1 and S2 with a normal node each, that is, one outside of M. With two faces M is outside of S1 and S2; with
   one face it lies in their union. No normal node of S1 or S2 hears more than f nodes outside its own set (with two
   faces, and outside of M). *)
Record apart (G : digraph) (f : nat) (two_faces local : bool) (M S1 S2 : set) : Prop := {
  bounded_M : obeys G f local M;
  normal_1 : exists i, i < nodes G /\ S1 i = true /\ M i = false;
  normal_2 : exists i, i < nodes G /\ S2 i = true /\ M i = false;
  apart_12 : disjoint G S1 S2;
  faces : if two_faces then disjoint G M S1 /\ disjoint G M S2
          else forall i, i < nodes G -> M i = true -> S1 i || S2 i = true;
  deaf_1 : forall i, i < nodes G -> S1 i = true -> M i = false ->
           size G (fun j => hears G i j && negb (S1 j || (two_faces && M j))) <= f;
  deaf_2 : forall i, i < nodes G -> S2 i = true -> M i = false ->
           size G (fun j => hears G i j && negb (S2 j || (two_faces && M j))) <= f }.

(* The network keeps together: no sets hold it apart. *)
Definition together (G : digraph) (f : nat) (two_faces local : bool) : Prop :=
  forall M S1 S2, apart G f two_faces local M S1 S2 -> False.
