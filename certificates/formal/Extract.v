(* To OCaml. Each line below is trusted: that the OCaml text does what the Coq constant means.

   nat becomes int (ExtrOcamlNatInt, and here under both names that Coq has for each operation): right below 2^62. All numbers here are counts of nodes, arcs and bytes, sums of at
   most n needs, and values of at most 10 decimal digits; limits of 2^30 bytes and 2^31 for r keep them far below.
   A word becomes an int of 62 bits: [w_bit] is called below [size] = 62 only, the other operations make no new bits. *)
From Coq Require Extraction ExtrOcamlBasic ExtrOcamlNatInt ExtrOcamlNativeString.
From Coq Require Import PeanoNat.
From Formal Require Import Bytes Sets Certificate.

Extract Inlined Constant Init.Nat.add => "(+)".
Extract Inlined Constant PeanoNat.Nat.add => "(+)".
Extract Inlined Constant Init.Nat.mul => "( * )".
Extract Inlined Constant PeanoNat.Nat.mul => "( * )".
Extract Inlined Constant Init.Nat.sub => "(fun (n : int) (m : int) -> if n < m then 0 else n - m)".
Extract Inlined Constant PeanoNat.Nat.sub => "(fun (n : int) (m : int) -> if n < m then 0 else n - m)".
Extract Inlined Constant Init.Nat.eqb => "((=) : int -> int -> bool)".
Extract Inlined Constant PeanoNat.Nat.eqb => "((=) : int -> int -> bool)".
Extract Inlined Constant Init.Nat.leb => "((<=) : int -> int -> bool)".
Extract Inlined Constant PeanoNat.Nat.leb => "((<=) : int -> int -> bool)".
Extract Inlined Constant Init.Nat.ltb => "((<) : int -> int -> bool)".
Extract Inlined Constant PeanoNat.Nat.ltb => "((<) : int -> int -> bool)".
Extract Inlined Constant Init.Nat.div => "(fun (n : int) (m : int) -> if m = 0 then 0 else n / m)".
Extract Inlined Constant PeanoNat.Nat.div => "(fun (n : int) (m : int) -> if m = 0 then 0 else n / m)".
Extract Inlined Constant Init.Nat.modulo => "(fun (n : int) (m : int) -> if m = 0 then n else n mod m)".
Extract Inlined Constant PeanoNat.Nat.modulo => "(fun (n : int) (m : int) -> if m = 0 then n else n mod m)".
Extract Inlined Constant Init.Nat.pow => "(fun (n : int) (m : int) -> let rec go k r = if k = 0 then r else go (k - 1) (r * n) in go m 1)".
Extract Inlined Constant PeanoNat.Nat.pow => "(fun (n : int) (m : int) -> let rec go k r = if k = 0 then r else go (k - 1) (r * n) in go m 1)".
Extract Inlined Constant Bytes.code => "Char.code".

Extract Constant Sets.word => "int".
Extract Inlined Constant Sets.w_zero => "0".
Extract Inlined Constant Sets.w_and => "(land)".
Extract Inlined Constant Sets.w_or => "(lor)".
Extract Inlined Constant Sets.w_diff => "(fun (a : int) (b : int) -> a land (lnot b))".
Extract Inlined Constant Sets.w_is0 => "(fun (a : int) -> a = 0)".
Extract Inlined Constant Sets.w_eqb => "(fun (a : int) (b : int) -> a = b)".
Extract Inlined Constant Sets.w_bit => "(fun (k : int) -> 1 lsl k)".
Extract Inlined Constant Sets.w_test => "(fun (a : int) (k : int) -> (a lsr k) land 1 = 1)".
Extract Constant Sets.w_pop => "(fun (a : int) ->
  let a = a - ((a lsr 1) land 0x1555555555555555) in
  let a = (a land 0x3333333333333333) + ((a lsr 2) land 0x3333333333333333) in
  let a = (a + (a lsr 4)) land 0x0F0F0F0F0F0F0F0F in
  (a * 0x0101010101010101) lsr 56)".

Extraction "checker.ml" verify w_pop.
