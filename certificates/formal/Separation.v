(* Replaying a refutation of sets that hold apart, as in certificates/separation.py and certificates/walk.py. *)
From Coq Require Import List Bool Arith.
From Formal Require Import Counting Bytes Sets Tables Rules Refutation Roles.
Import ListNotations.

(* What the last look at a side saw: how many were left, T, D, L and Z. *)
Record glance := Glance { g_left : nat; g_T : bits; g_D : bits; g_L : bits; g_Z : bits }.

(* The nodes worth a look: all of P, or those about which something has changed. *)
Definition worth_it (t : threat) (a : part) (Z : bits) (left : nat) (last : option glance) : bits :=
  match last with
  | Some l =>
    if local t || (g_left l =? left) then
      inter (pP a) (union (diff (pT a) (g_T l))
        (hearing (groups (asks t)) (union (union (differ (g_D l) (sure_of a Z)) (differ (g_L l) (loose_of a Z)))
                                          (if local t then differ (g_Z l) Z else [])) []))
    else pP a
  | None => pP a
  end.
Definition glance_at (t : threat) (a : part) (Z : bits) (left : nat) : glance := Glance left (pT a) (sure_of a Z) (loose_of a Z) Z.

Definition hark_here (t : threat) (s : roles) (last : option glance) : option roles :=
  let a := here s in
  let left := left_total t (bad s) in
  match hark t left (groups (asks t)) (worth_it t a (bad s) left last) (sure_of a (bad s)) (loose_of a (bad s)) (bad s) (pT a) (pP a) (pF a) with
  | Some (P, F) => Some (Roles (Part P (pQ a) F (pT a)) (there s) (bad s))
  | None => None
  end.

Inductive settled_roles := Empty | Rest (s : roles) | Endless.

Fixpoint settle_roles (fuel : nat) (t : threat) (s : roles) (seen_here seen_there : option glance) : settled_roles :=
  match fuel with
  | 0 => Endless
  | S fuel' =>
    let s1 := role (rounds (asks t)) (two_faces t) s in
    if impossible (two_faces t) s1 then Empty else
    match budget t s1 with
    | None => Empty
    | Some s2 =>
      if negb (equal_roles s1 s2) then settle_roles fuel' t s2 seen_here seen_there else
      let left := left_total t (bad s2) in
      match hark_here t s2 seen_here with
      | None => Empty
      | Some s3 =>
        match hark_here t (flip s3) seen_there with
        | None => Empty
        | Some s4 =>
          let now_here := Some (glance_at t (here s2) (bad s2) left) in
          let now_there := Some (glance_at t (there s2) (bad s2) left) in
          if negb (equal_roles s2 (flip s4)) then settle_roles fuel' t (flip s4) now_here now_there
          else if shares t s2 then Rest s2 else Empty
        end
      end
    end
  end.
Definition settle_all (t : threat) (s : roles) : settled_roles := settle_roles (rounds (asks t)) t s None None.

(* EXCLUDE j i, from the byte after the opcode: the place after it, and the state without j, or None when j is in T. *)
Definition exclude_here (t : threat) (body : bytes) (pos : nat) (s : roles) : option (nat * option roles) :=
  match node (asks t) body pos with
  | None => None
  | Some (x, pos1) =>
    match node (asks t) body pos1 with
    | None => None
    | Some (y, pos2) =>
      let a := here s in
      if mem (pP a) (id x) && mem (pT (there s)) (id y) && crowds_out t s x y then
        if mem (pT a) (id x) then Some (pos2, None)
        else Some (pos2, Some (Roles (Part (diff (pP a) (self x)) (pQ a) (pF a) (pT a)) (there s) (bad s)))
      else None
    end
  end.

Inductive counted_roles := ClosedAt (pos : nat) | OpenAt (pos : nat) (s : roles) | WrongAt (pos : nat).

(* The runs of EXCLUDE, each followed by PROPAGATE, before a branch. [run]: an EXCLUDE came just before. *)
Fixpoint count_roles (fuel : nat) (t : threat) (body : bytes) (pos : nat) (s : roles) (run : bool) : counted_roles :=
  match fuel with
  | 0 => WrongAt pos
  | S fuel' =>
    let op := next body pos in
    if op =? 6 then
      match exclude_here t body (S pos) s with
      | Some (pos', Some s') => count_roles fuel' t body pos' s' true
      | Some (pos', None) => ClosedAt pos'
      | None => WrongAt pos
      end
    else if op =? 7 then
      match exclude_here t body (S pos) (flip s) with
      | Some (pos', Some s') => count_roles fuel' t body pos' (flip s') true
      | Some (pos', None) => ClosedAt pos'
      | None => WrongAt pos
      end
    else if run then
      if op =? 0 then
        match settle_all t s with
        | Empty => ClosedAt (S pos)
        | Rest s' => count_roles fuel' t body (S pos) s' false
        | Endless => WrongAt pos
        end
      else WrongAt pos
    else OpenAt pos s
  end.

(* The true and the false child of a literal on this side. *)
Definition normal_branch (s : roles) (x : row) : option (roles * roles) :=
  let a := here s in
  if mem (pP a) (id x) && negb (mem (pT a) (id x)) then
    Some (Roles (Part (pP a) (pQ a) (pF a) (union (pT a) (self x))) (there s) (bad s),
          Roles (Part (diff (pP a) (self x)) (pQ a) (pF a) (pT a)) (there s) (bad s))
  else None.
Definition bad_branch (two : bool) (s : roles) (x : row) : option (roles * roles) :=
  let a := here s in let b := there s in
  if mem (pQ a) (id x) && negb (mem (bad s) (id x) && mem (pF a) (id x)) then
    Some (Roles (Part (pP a) (pQ a) (union (pF a) (self x)) (pT a)) b (union (bad s) (self x)),
          Roles (Part (pP a) (diff (pQ a) (self x)) (pF a) (pT a))
                (if two then Part (pP b) (diff (pQ b) (self x)) (pF b) (pT b) else b) (bad s))
  else None.
Definition flip_both (r : option (roles * roles)) : option (roles * roles) :=
  match r with Some (yes, no) => Some (flip yes, flip no) | None => None end.

(* The false child of ROOT alone is symmetric: it has the part without x on both sides. *)
Definition branch_roles (two : bool) (op : nat) (s : roles) (x : row) (symmetric : bool) : option (roles * roles) :=
  match op with
  | 1 => if symmetric && equal_parts (here s) (there s) then
           match normal_branch s x with Some (yes, no) => Some (yes, Roles (here no) (here no) (bad s)) | None => None end
         else None
  | 2 => normal_branch s x
  | 3 => flip_both (normal_branch (flip s) x)
  | 4 => bad_branch two s x
  | 5 => flip_both (bad_branch two (flip s) x)
  | _ => None
  end.

(* The tree in preorder; [waiting] are the false children to come, each with whether it is symmetric. *)
Fixpoint walk_roles (fuel : nat) (t : threat) (body : bytes) (pos : nat) (s : roles) (symmetric : bool)
  (waiting : list (roles * bool)) : replay :=
  match fuel with
  | 0 => Refused pos
  | S fuel' =>
    let close pos' :=
      match waiting with
      | [] => if pos' =? len body then Refuted else Refused pos'
      | (s', symmetric') :: rest => walk_roles fuel' t body pos' s' symmetric' rest
      end in
    match settle_all t s with
    | Empty => close pos
    | Endless => Refused pos
    | Rest s1 =>
      match count_roles (S (len body)) t body pos s1 false with
      | ClosedAt pos' => close pos'
      | WrongAt pos' => Refused pos'
      | OpenAt pos' s2 =>
        match node (asks t) body (S pos') with
        | Some (x, pos2) =>
          let op := next body pos' in
          match branch_roles (two_faces t) op s2 x symmetric with
          | Some (yes, no) => walk_roles fuel' t body pos2 yes false ((no, op =? 1) :: waiting)
          | None => Refused pos'
          end
        | None => Refused pos'
        end
      end
    end
  end.

Definition keeps_together (t : threat) (body : bytes) : replay :=
  let nobody := diff (full (asks t)) (full (asks t)) in
  let anybody := Part (full (asks t)) (full (asks t)) nobody nobody in
  walk_roles (2 * len body + 2) t body 0 (Roles anybody anybody nobody) true [].
