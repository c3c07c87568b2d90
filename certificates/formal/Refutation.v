(* Replaying a refutation, as in certificates/rules.py (settle) and certificates/refutation.py, and its theorem. *)
From Coq Require Import List Bool Arith Lia.
From Formal Require Import Counting Bytes Sets Rules Soundness.
Import ListNotations.

(* The rows of all nodes, word by word and by number, all nodes as a set, n, and s - 1. [rounds] is more than a
   settling can take: every round but the last two changes one of 8 n memberships or 2 n bounds. *)
Record question := Question {
  groups : list (list row); row_of : nat -> option row; full : bits; limit : nat; spare : nat; rounds : nat }.

(* What the last look at a side saw: t, T, C and D. *)
Record seen := Seen { seen_t : nat; seen_T : bits; seen_C : bits; seen_D : bits }.

Definition differ (a b : bits) : bits := union (diff a b) (diff b a).

(* The nodes worth a look: all of P, or those about which something has changed. *)
Definition worth (q : question) (a : side) (t : nat) (last : option seen) : bits :=
  match last with
  | Some l =>
    if seen_t l =? t then
      inter (sP a) (union (diff (sT a) (seen_T l))
        (hearing (groups q) (union (differ (seen_C l) (sC a)) (differ (seen_D l) (sure a))) []))
    else sP a
  | None => sP a
  end.

Definition pass (q : question) (a : side) (t : nat) (last : option seen) : option side :=
  match look (groups q) (worth q a t last) (sure a) (loose a) t (sT a) (sP a) (sF a) with
  | Some (P, F) => Some (Side (sC a) P F (sT a))
  | None => None
  end.

Definition unchanged (a b : side) : bool := equal (sP a) (sP b) && equal (sF a) (sF b).

Inductive settled := Contradiction | Settled (a b : side) (left la lb : nat) | Stuck.

Fixpoint settle (fuel : nat) (q : question) (a b : side) (la lb : nat) (seen_a seen_b : option seen) : settled :=
  match fuel with
  | 0 => Stuck
  | S fuel' =>
    let a0 := take_T a in
    let b0 := take_T b in
    match member a0 (sF b0), member b0 (sF a0) with
    | Some a1, Some b1 =>
      let gone := count 0 (full q) (known a1) + count 0 (full q) (known b1) in
      if spare q <? gone then Contradiction else
      let left := spare q - gone in
      let ta := smaller la left in
      let tb := smaller lb left in
      let a2 := spent a1 ta in
      let b2 := spent b1 tb in
      match pass q a2 ta seen_a with
      | None => Contradiction
      | Some a3 =>
        match pass q b2 tb seen_b with
        | None => Contradiction
        | Some b3 =>
          let now_a := Some (Seen ta (sT a2) (sC a2) (sure a2)) in
          let now_b := Some (Seen tb (sT b2) (sC b2) (sure b2)) in
          if negb (unchanged a2 a3 && unchanged b2 b3) then settle fuel' q a3 b3 la lb now_a now_b else
          if left =? 0 then Settled a3 b3 left ta tb else
          let fair_a := left - least_exempt (rounds q) (groups q) b3 left in
          let fair_b := left - least_exempt (rounds q) (groups q) a3 left in
          if (fair_a <? ta) || (fair_b <? tb) then
            settle fuel' q a3 b3 (smaller la fair_a) (smaller lb fair_b) now_a now_b
          else Settled a3 b3 left ta tb
        end
      end
    | _, _ => Contradiction
    end
  end.

(* A number below [below]: seven bits a byte, low first, shortest spelling; [k] more bytes may come. *)
Fixpoint number (k : nat) (body : bytes) (below pos value unit : nat) : option (nat * nat) :=
  match k with
  | 0 => None
  | S k' =>
    if pos <? len body then
      let b := byte_at body pos in
      let value' := value + (b mod n128) * unit in
      if b <? n128 then
        if (value' <? below) && ((unit =? 1) || (0 <? b)) then Some (value', S pos) else None
      else number k' body below (S pos) value' (unit * n128)
    else None
  end.

Definition node (q : question) (body : bytes) (pos : nat) : option (row * nat) :=
  match number 5 body (limit q) pos 0 1 with
  | Some (v, pos') =>
    match row_of q v with Some x => if id x =? v then Some (x, pos') else None | None => None end
  | None => None
  end.

(* EXCLUDE j i1 [i2] on the side [a], from the byte after the opcode: the place after it, and the side without j, or
   None when j is in T. *)
Definition blocker (q : question) (body : bytes) (b : side) (pos : nat) : option (row * nat) :=
  match node q body pos with
  | Some (y, pos') => if mem (sT b) (id y) then Some (y, pos') else None
  | None => None
  end.

Definition exclude (q : question) (body : bytes) (pos : nat) (a b : side) (left lb : nat) (two : bool)
  : option (nat * option side) :=
  match node q body pos with
  | None => None
  | Some (x, pos1) =>
    match blocker q body b pos1 with
    | None => None
    | Some (y, pos2) =>
      match (if two then match blocker q body b pos2 with
                         | Some (z, pos3) => if id y =? id z then None else Some ([y; z], pos3)
                         | None => None end
             else Some ([y], pos2)) with
      | None => None
      | Some (blockers, end_) =>
        if mem (sP a) (id x) && excludes a b left lb x blockers then
          if mem (sT a) (id x) then Some (end_, None)
          else Some (end_, Some (Side (sC a) (diff (sP a) (self x)) (sF a) (sT a)))
        else None
      end
    end
  end.

Inductive counted := Closed (pos : nat) | Open (pos : nat) (a b : side) | Wrong (pos : nat).

(* The runs of EXCLUDE, each followed by PROPAGATE, before a branch. [run]: an EXCLUDE came just before. *)
Fixpoint counts (fuel : nat) (q : question) (body : bytes) (pos : nat) (a b : side) (left la lb : nat) (run : bool)
  : counted :=
  match fuel with
  | 0 => Wrong pos
  | S fuel' =>
    let op := next body pos in
    if (6 <=? op) && (op <? 10) then
      let two := 8 <=? op in
      if op mod 2 =? 0 then
        match exclude q body (S pos) a b left lb two with
        | Some (pos', Some a') => counts fuel' q body pos' a' b left la lb true
        | Some (pos', None) => Closed pos'
        | None => Wrong pos
        end
      else
        match exclude q body (S pos) b a left la two with
        | Some (pos', Some b') => counts fuel' q body pos' a b' left la lb true
        | Some (pos', None) => Closed pos'
        | None => Wrong pos
        end
    else if run then
      if op =? 0 then
        match settle (rounds q) q a b (spare q) (spare q) None None with
        | Contradiction => Closed (S pos)
        | Settled a' b' left' la' lb' => counts fuel' q body (S pos) a' b' left' la' lb' false
        | Stuck => Wrong pos
        end
      else Wrong pos
    else Open pos a b
  end.

(* The true and the false child of a literal on one side. *)
Definition satisfied_branch (a : side) (x : row) : option (side * side) :=
  if mem (sP a) (id x) && negb (mem (sT a) (id x)) then
    Some (Side (sC a) (sP a) (sF a) (union (sT a) (self x)), Side (sC a) (diff (sP a) (self x)) (sF a) (sT a))
  else None.
Definition member_branch (a : side) (x : row) : option (side * side) :=
  if mem (sC a) (id x) && negb (mem (sF a) (id x)) then
    Some (Side (sC a) (sP a) (union (sF a) (self x)) (sT a),
          Side (diff (sC a) (self x)) (diff (sP a) (self x)) (sF a) (sT a))
  else None.

Definition equal_sides (a b : side) : bool :=
  equal (sC a) (sC b) && equal (sP a) (sP b) && equal (sF a) (sF b) && equal (sT a) (sT b).

(* The two children of a branch; the false child of ROOT alone is symmetric. *)
Definition state := (side * side)%type.
Definition branch (op : nat) (a b : side) (x : row) (symmetric : bool) : option (state * state) :=
  match op with
  | 1 => if symmetric && equal_sides a b then
           match satisfied_branch a x with Some (yes, no) => Some ((yes, b), (no, no)) | None => None end
         else None
  | 2 => match satisfied_branch a x with Some (yes, no) => Some ((yes, b), (no, b)) | None => None end
  | 3 => match satisfied_branch b x with Some (yes, no) => Some ((a, yes), (a, no)) | None => None end
  | 4 => match member_branch a x with Some (yes, no) => Some ((yes, b), (no, b)) | None => None end
  | 5 => match member_branch b x with Some (yes, no) => Some ((a, yes), (a, no)) | None => None end
  | _ => None
  end.

Inductive replay := Refuted | Refused (pos : nat).

(* The tree in preorder; [waiting] are the false children to come, each with whether it is symmetric. *)
Fixpoint walk (fuel : nat) (q : question) (body : bytes) (pos : nat) (a b : side) (symmetric : bool)
  (waiting : list (state * bool)) : replay :=
  match fuel with
  | 0 => Refused pos
  | S fuel' =>
    let close pos' :=
      match waiting with
      | [] => if pos' =? len body then Refuted else Refused pos'
      | ((a', b'), symmetric') :: rest => walk fuel' q body pos' a' b' symmetric' rest
      end in
    match settle (rounds q) q a b (spare q) (spare q) None None with
    | Contradiction => close pos
    | Stuck => Refused pos
    | Settled a1 b1 more la lb =>
      match counts (S (len body)) q body pos a1 b1 more la lb false with
      | Closed pos' => close pos'
      | Wrong pos' => Refused pos'
      | Open pos' a2 b2 =>
        match node q body (S pos') with
        | Some (x, pos2) =>
          let op := next body pos' in
          match branch op a2 b2 x symmetric with
          | Some ((a3, b3), no) => walk fuel' q body pos2 a3 b3 false ((no, op =? 1) :: waiting)
          | None => Refused pos'
          end
        | None => Refused pos'
        end
      end
    end
  end.

Definition refutes (q : question) (body : bytes) : replay :=
  let everything := Side (full q) (full q) [] [] in
  walk (2 * len body + 2) q body 0 everything everything true [].
