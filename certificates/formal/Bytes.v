(* Files of bytes, and the bytes and numbers that the formats name. Each number is a definition of its own, because
   extraction writes every number out as so many successors of 0. *)
From Coq Require Import List Bool Arith String Ascii.
Import ListNotations.

(* A file: so many bytes, and which byte stands where. *)
Record bytes := Bytes { len : nat; byte_at : nat -> nat }.
Definition contents (b : bytes) : list nat := map (byte_at b) (seq 0 (len b)).

(* ASCII text as numbers. *)
Definition code (c : ascii) : nat := nat_of_ascii c.
Definition text (s : string) : list nat := map code (list_ascii_of_string s).

Definition n16 := Nat.pow 2 4.
Definition n32 := Nat.pow 2 5.
Definition n64 := Nat.pow 2 6.
Definition n128 := Nat.pow 2 7.
Definition n256 := Nat.pow 2 8.
Definition n1024 := Nat.pow 2 10.
Definition n4096 := Nat.pow 2 12.
Definition n65536 := Nat.pow 2 16.
(* The first surrogates, high and low, what follows them, and the end of Unicode. *)
Definition high_surrogates := 216 * n256.
Definition low_surrogates := 220 * n256.
Definition after_surrogates := 224 * n256.
Definition end_of_unicode := 17 * n65536.

Definition quote := code """"%char.
Definition backslash := code "\"%char.
Definition comma := code ","%char.
Definition colon := code ":"%char.
Definition point := code "."%char.
Definition minus := code "-"%char.
Definition plus := code "+"%char.
Definition slash := code "/"%char.
Definition list_opens := code "["%char.
Definition list_closes := code "]"%char.
Definition object_opens := code "{"%char.
Definition object_closes := code "}"%char.
Definition digit_0 := code "0"%char.
Definition digit_9 := code "9"%char.
Definition letter_a := code "a"%char.
Definition letter_b := code "b"%char.
Definition letter_e := code "e"%char.
Definition letter_f := code "f"%char.
Definition letter_n := code "n"%char.
Definition letter_r := code "r"%char.
Definition letter_t := code "t"%char.
Definition letter_u := code "u"%char.
Definition capital_A := code "A"%char.
Definition capital_E := code "E"%char.
Definition capital_F := code "F"%char.
Definition blank := code " "%char.

(* The byte at a place; 256 beyond the end. *)
Definition next (b : bytes) (pos : nat) : nat := if pos <? len b then byte_at b pos else n256.
