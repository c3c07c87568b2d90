(* What the theorems rest on: nothing but Coq. *)
From Formal Require Import Certificate.
Print Assumptions verify_sound.
