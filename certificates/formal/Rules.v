(* The rules of a refutation, as in certificates/rules.py and under the same names. Soundness.v has their lemmas.

   A rule is written for one side; for the other side it is used with the two sides exchanged. *)
From Coq Require Import List Bool Arith.
From Formal Require Import Counting Sets.
Import ListNotations.

(* One side of a state: candidates, possibly satisfied nodes, members, satisfied members. *)
Record side := Side { sC : bits; sP : bits; sF : bits; sT : bits }.

(* What the checker keeps of a node: its number, its bit in a word, the set of itself, whom it hears, who hears it,
   and its need. *)
Record row := Row { id : nat; bit : word; self : bits; hear : bits; heard_by : bits; need : nat }.

(* [sure]: D = P u F. [loose]: C \ D. [known]: F \ P, exempt for certain. *)
Definition sure (a : side) : bits := union (sP a) (sF a).
Definition loose (a : side) : bits := diff (sC a) (sure a).
Definition known (a : side) : bits := diff (sF a) (sP a).

(* *member*, for a side [a] whose opposite has the members [F']; both have taken in T before. *)
Definition take_T (a : side) : side := Side (sC a) (sP a) (union (sF a) (sT a)) (sT a).
Definition member (a : side) (F' : bits) : option side :=
  let C := diff (sC a) F' in
  let P := inter (sP a) C in
  if subset (sF a) C && subset (sT a) P && negb (isempty P) then Some (Side C P (sF a) (sT a)) else None.

(* *spent*, t = min(b, b_k). *)
Definition spent (a : side) (t : nat) : side :=
  if t =? 0 then Side (sure a) (sP a) (sF a) (inter (sP a) (sF a)) else a.

Definition smaller (a b : nat) : nat := if a <=? b then a else b.

(* *peel* and *force* at those nodes of a word that are in [w]; D, L = C \ D and t are those of the beginning. *)
Fixpoint look_word (rows : list row) (w : word) (D L : bits) (t : nat) (T P F : bits) : option (bits * bits) :=
  match rows with
  | [] => Some (P, F)
  | x :: rest =>
    if w_is0 (w_and w (bit x)) then look_word rest w D L t T P F else
    let k := need x in
    let inside := count 0 (hear x) D in
    if k <? inside then look_word rest w D L t T P F else
    let extra := count 0 (hear x) L in
    let reach := inside + smaller extra t in
    if reach <? k then
      (if mem T (id x) then None else look_word rest w D L t T (diff P (self x)) F)
    else if (reach =? k) && mem T (id x) then
      look_word rest w D L t T P (union F (inter (hear x) (if extra <=? t then union D L else D)))
    else look_word rest w D L t T P F
  end.

Fixpoint look (groups : list (list row)) (nodes : bits) (D L : bits) (t : nat) (T P F : bits) : option (bits * bits) :=
  match groups, nodes with
  | rows :: groups', w :: nodes' =>
    if w_is0 w then look groups' nodes' D L t T P F else
    match look_word rows w D L t T P F with
    | Some (P', F') => look groups' nodes' D L t T P' F'
    | None => None
    end
  | _, _ => Some (P, F)
  end.

(* *share*: is the largest subset Q of P whose nodes hear enough possible members, with t more, not empty and a
   superset of T? *)
Fixpoint keep_word (rows : list row) (w : word) (D L : bits) (t : nat) (Q : bits) : bits :=
  match rows with
  | [] => Q
  | x :: rest =>
    if w_is0 (w_and w (bit x)) then keep_word rest w D L t Q else
    let inside := count 0 (hear x) D in
    if need x <=? inside then keep_word rest w D L t Q else
    if inside + smaller (count 0 (hear x) L) t <? need x
    then keep_word rest w D L t (diff Q (self x)) else keep_word rest w D L t Q
  end.

Fixpoint keep (groups : list (list row)) (nodes : bits) (D L : bits) (t : nat) (Q : bits) : bits :=
  match groups, nodes with
  | rows :: groups', w :: nodes' =>
    keep groups' nodes' D L t (if w_is0 w then Q else keep_word rows w D L t Q)
  | _, _ => Q
  end.

(* Who hears a node of [changed]: nobody else can have become worth a look. *)
Fixpoint hearing_word (rows : list row) (w : word) (found : bits) : bits :=
  match rows with
  | [] => found
  | x :: rest => hearing_word rest w (if w_is0 (w_and w (bit x)) then found else union found (heard_by x))
  end.

Fixpoint hearing (groups : list (list row)) (changed : bits) (found : bits) : bits :=
  match groups, changed with
  | rows :: groups', w :: changed' => hearing groups' changed' (if w_is0 w then found else hearing_word rows w found)
  | _, _ => found
  end.

Fixpoint suffices (fuel : nat) (groups : list (list row)) (a : side) (t : nat) (Q nodes : bits) : bool :=
  match fuel with
  | 0 => true
  | S fuel' =>
    if isempty Q || negb (subset (sT a) Q) then false else
    let D := union Q (sF a) in
    let Q' := keep groups nodes D (diff (sC a) D) t Q in
    if equal Q' Q then true else suffices fuel' groups a t Q' (inter Q' (hearing groups (diff Q Q') []))
  end.

(* The least t that suffices, by bisection in low .. high: low - 1 does not. *)
Fixpoint least (fuel : nat) (enough : nat -> bool) (low high : nat) : nat :=
  match fuel with
  | 0 => low
  | S fuel' =>
    if low <? high then
      let middle := (low + high) / 2 in
      if enough middle then least fuel' enough low middle else least fuel' enough (S middle) high
    else low
  end.

Definition least_exempt (fuel : nat) (groups : list (list row)) (a : side) (left : nat) : nat :=
  let enough t := suffices fuel groups a t (sP a) (sP a) in
  if enough 0 then 0 else least fuel enough 1 left.

(* *count*: do the blockers, satisfied on the side [b], leave too few nodes for x on the side [a]? [lb] is b_k of [b]. *)
Fixpoint heard_total (blockers : list row) (D : bits) : nat :=
  match blockers with [] => 0 | y :: rest => count 0 (hear y) D + heard_total rest D end.
Fixpoint need_total (blockers : list row) : nat :=
  match blockers with [] => 0 | y :: rest => need y + need_total rest end.
Fixpoint heard_any (blockers : list row) (D own : bits) : bits :=
  match blockers with [] => own | y :: rest => heard_any rest D (diff own (inter (hear y) D)) end.
Definition excludes (a b : side) (left lb : nat) (x : row) (blockers : list row) : bool :=
  heard_total blockers (diff (sure b) (self x)) + count 0 (hear x) (heard_any blockers (sure b) (sure a))
  + left + (length blockers - 1) * lb
  <? need_total blockers + need x.
