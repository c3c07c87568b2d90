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

(* What is remembered of the last looks, and of the last budget: Z and Q1 u Q2. It need not be right. *)
Record memory := Memory { of_here : option glance; of_there : option glance; of_budget : option (bits * bits) }.
Definition forgotten : memory := Memory None None None.

Definition budget_now (t : threat) (s : roles) (m : memory) : option roles :=
  match of_budget m with
  | Some (Z, maybe) => if equal Z (bad s) && equal maybe (union (pQ (here s)) (pQ (there s))) then Some s else budget t s
  | None => budget t s
  end.

Inductive settled_roles := Empty | Rest (s : roles) (m : memory) | Endless.

Fixpoint settle_roles (fuel : nat) (t : threat) (s : roles) (m : memory) : settled_roles :=
  match fuel with
  | 0 => Endless
  | S fuel' =>
    let s1 := role (rounds (asks t)) (two_faces t) s in
    if impossible (two_faces t) s1 then Empty else
    match budget_now t s1 m with
    | None => Empty
    | Some s2 =>
      let kept := Some (bad s1, union (pQ (here s1)) (pQ (there s1))) in
      if negb (equal_roles s1 s2) then settle_roles fuel' t s2 (Memory (of_here m) (of_there m) kept) else
      let left := left_total t (bad s2) in
      match hark_here t s2 (of_here m) with
      | None => Empty
      | Some s3 =>
        match hark_here t (flip s3) (of_there m) with
        | None => Empty
        | Some s4 =>
          let now := Memory (Some (glance_at t (here s2) (bad s2) left)) (Some (glance_at t (there s2) (bad s2) left)) kept in
          if negb (equal_roles s2 (flip s4)) then settle_roles fuel' t (flip s4) now
          else if shares t s2 then Rest s2 now else Empty
        end
      end
    end
  end.
Definition settle_all (t : threat) (s : roles) (m : memory) : settled_roles := settle_roles (rounds (asks t)) t s m.

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

Inductive counted_roles := ClosedAt (pos : nat) | OpenAt (pos : nat) (s : roles) (m : memory) | WrongAt (pos : nat).

(* The runs of EXCLUDE, each followed by PROPAGATE, before a branch. [run]: an EXCLUDE came just before. *)
Fixpoint count_roles (fuel : nat) (t : threat) (body : bytes) (pos : nat) (s : roles) (m : memory) (run : bool)
  : counted_roles :=
  match fuel with
  | 0 => WrongAt pos
  | S fuel' =>
    let op := next body pos in
    if op =? 6 then
      match exclude_here t body (S pos) s with
      | Some (pos', Some s') => count_roles fuel' t body pos' s' m true
      | Some (pos', None) => ClosedAt pos'
      | None => WrongAt pos
      end
    else if op =? 7 then
      match exclude_here t body (S pos) (flip s) with
      | Some (pos', Some s') => count_roles fuel' t body pos' (flip s') m true
      | Some (pos', None) => ClosedAt pos'
      | None => WrongAt pos
      end
    else if run then
      if op =? 0 then
        match settle_all t s m with
        | Empty => ClosedAt (S pos)
        | Rest s' m' => count_roles fuel' t body (S pos) s' m' false
        | Endless => WrongAt pos
        end
      else WrongAt pos
    else OpenAt pos s m
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

(* The tree in preorder; [waiting] are the false children to come, each with what is remembered and whether it is
   symmetric. *)
Fixpoint walk_roles (fuel : nat) (t : threat) (body : bytes) (pos : nat) (s : roles) (m : memory) (symmetric : bool)
  (waiting : list (roles * memory * bool)) : replay :=
  match fuel with
  | 0 => Refused pos
  | S fuel' =>
    let close pos' :=
      match waiting with
      | [] => if pos' =? len body then Refuted else Refused pos'
      | (s', m', symmetric') :: rest => walk_roles fuel' t body pos' s' m' symmetric' rest
      end in
    match settle_all t s m with
    | Empty => close pos
    | Endless => Refused pos
    | Rest s1 m1 =>
      match count_roles (S (len body)) t body pos s1 m1 false with
      | ClosedAt pos' => close pos'
      | WrongAt pos' => Refused pos'
      | OpenAt pos' s2 m2 =>
        match node (asks t) body (S pos') with
        | Some (x, pos2) =>
          let op := next body pos' in
          match branch_roles (two_faces t) op s2 x symmetric with
          | Some (yes, no) =>
            let m3 := if op =? 1 then Memory (of_here m2) (of_here m2) (of_budget m2) else m2 in
            walk_roles fuel' t body pos2 yes m2 false ((no, m3, op =? 1) :: waiting)
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
  walk_roles (2 * len body + 2) t body 0 (Roles anybody anybody nobody) forgotten true [].
