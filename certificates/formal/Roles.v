(* The rules of a refutation of sets that hold apart, as in certificates/roles.py and under the same names.
   RolesSound.v has their lemmas.

   An operation is written for one side; for the other side the state is flipped before and after. *)
From Coq Require Import List Bool Arith.
From Formal Require Import Counting Sets Tables Rules Refutation.
Import ListNotations.

(* One side of a state: possibly normal, possibly malicious, inside, normal; and a state with its malicious nodes. *)
Record part := Part { pP : bits; pQ : bits; pF : bits; pT : bits }.
Record roles := Roles { here : part; there : part; bad : bits }.
Definition flip (s : roles) : roles := Roles (there s) (here s) (bad s).

(* The question: rows with the needs max(0, d - f), and f in [spare]; two faces or one; locally or in total. *)
Record threat := Threat { asks : question; two_faces : bool; local : bool }.
Definition most (t : threat) : nat := spare (asks t).

(* D: who can be inside without a further malicious node. L: who can be one of these. *)
Definition sure_of (a : part) (Z : bits) : bits := union (union (pP a) (pF a)) (inter Z (pQ a)).
Definition loose_of (a : part) (Z : bits) : bits := diff (pQ a) (sure_of a Z).

(* *role*, operation by operation *)
Definition inside_T (s : roles) : roles :=
  let a := here s in Roles (Part (pP a) (pQ a) (union (pF a) (pT a)) (pT a)) (there s) (bad s).
Definition not_normal (s : roles) : roles :=
  let a := here s in Roles (Part (pP a) (diff (pQ a) (union (pT a) (pT (there s)))) (pF a) (pT a)) (there s) (bad s).
Definition by_faces (two : bool) (s : roles) : roles :=
  let a := here s in
  if two then Roles a (there s) (union (bad s) (inter (pF a) (pF (there s))))
  else Roles (Part (pP a) (diff (pQ a) (pF (there s))) (pF a) (pT a)) (there s) (bad s).
Definition not_P (s : roles) : roles :=
  let a := here s in Roles a (there s) (union (bad s) (diff (pF a) (pP a))).
Definition no_room (s : roles) : roles :=
  let a := here s in Roles (Part (diff (pP a) (union (bad s) (pF (there s)))) (pQ a) (pF a) (pT a)) (there s) (bad s).
Definition inside_Z (two : bool) (s : roles) : roles :=
  let a := here s in
  Roles (Part (pP a) (pQ a) (union (pF a) (if two then bad s else diff (bad s) (pQ (there s)))) (pT a)) (there s) (bad s).
Definition not_Q (s : roles) : roles :=
  let a := here s in Roles (Part (pP a) (pQ a) (pF a) (union (pT a) (diff (pF a) (pQ a)))) (there s) (bad s).

Definition both (op : roles -> roles) (s : roles) : roles := flip (op (flip (op s))).
Definition role_once (two : bool) (s : roles) : roles :=
  both (fun s => not_Q (inside_Z two (no_room s))) (both not_P (both (by_faces two) (both not_normal (both inside_T s)))).

Definition equal_parts (a b : part) : bool :=
  equal (pP a) (pP b) && equal (pQ a) (pQ b) && equal (pF a) (pF b) && equal (pT a) (pT b).
Definition equal_roles (s u : roles) : bool :=
  equal_parts (here s) (here u) && equal_parts (there s) (there u) && equal (bad s) (bad u).

Fixpoint role (fuel : nat) (two : bool) (s : roles) : roles :=
  match fuel with
  | 0 => s
  | S fuel' => let u := role_once two s in if equal_roles s u then u else role fuel' two u
  end.
Definition impossible (two : bool) (s : roles) : bool :=
  negb (subset (bad s) (union (pQ (here s)) (pQ (there s)))) || isempty (pP (here s)) || isempty (pP (there s))
  || (negb two && negb (isempty (inter (pF (here s)) (pF (there s))))).

(* *budget* *)
Definition budget_total (f : nat) (full : bits) (s : roles) : option roles :=
  let Z := bad s in
  let used := count 0 full Z in
  if f <? used then None
  else if used =? f then
    let a := here s in let b := there s in
    Some (Roles (Part (pP a) (inter (pQ a) Z) (pF a) (pT a)) (Part (pP b) (inter (pQ b) Z) (pF b) (pT b)) Z)
  else Some s.

Fixpoint budget_word (rows : list row) (w : word) (f : nat) (maybe Z Qa Qb : bits) : option (bits * bits * bits) :=
  match rows with
  | [] => Some (Z, Qa, Qb)
  | x :: rest =>
    if w_is0 (w_and w (bit x)) then budget_word rest w f maybe Z Qa Qb else
    let used := count 0 (hear x) Z in
    if f <? used then
      (if mem maybe (id x) then budget_word rest w f maybe (union Z (self x)) Qa Qb else None)
    else if (used =? f) && negb (mem maybe (id x)) then
      let gone := diff (hear x) Z in budget_word rest w f maybe Z (diff Qa gone) (diff Qb gone)
    else budget_word rest w f maybe Z Qa Qb
  end.
Fixpoint budget_local (groups : list (list row)) (nodes : bits) (f : nat) (maybe Z Qa Qb : bits)
  : option (bits * bits * bits) :=
  match groups, nodes with
  | rows :: groups', w :: nodes' =>
    if w_is0 w then budget_local groups' nodes' f maybe Z Qa Qb else
    match budget_word rows w f maybe Z Qa Qb with
    | Some (Z', Qa', Qb') => budget_local groups' nodes' f maybe Z' Qa' Qb'
    | None => None
    end
  | _, _ => Some (Z, Qa, Qb)
  end.

Definition budget (t : threat) (s : roles) : option roles :=
  if local t then
    let a := here s in let b := there s in
    match budget_local (groups (asks t)) (diff (full (asks t)) (bad s)) (most t) (union (pQ a) (pQ b)) (bad s) (pQ a) (pQ b) with
    | Some (Z, Qa, Qb) => Some (Roles (Part (pP a) Qa (pF a) (pT a)) (Part (pP b) Qb (pF b) (pT b)) Z)
    | None => None
    end
  else budget_total (most t) (full (asks t)) s.

(* How many further malicious nodes there can be, or a normal node can hear. *)
Definition left_total (t : threat) (Z : bits) : nat := most t - count 0 (full (asks t)) Z.
Definition left_of (t : threat) (Z : bits) (left : nat) (x : row) : nat :=
  if local t then most t - count 0 (hear x) Z else left.

(* *peel* and *force* at those nodes of a word that are in [w] *)
Fixpoint hark_word (t : threat) (left : nat) (rows : list row) (w : word) (D L Z T P F : bits) : option (bits * bits) :=
  match rows with
  | [] => Some (P, F)
  | x :: rest =>
    if w_is0 (w_and w (bit x)) then hark_word t left rest w D L Z T P F else
    let held := count 0 (hear x) D in
    if need x <? held then hark_word t left rest w D L Z T P F else
    let extra := count 0 (hear x) L in
    let b := left_of t Z left x in
    let reach := held + smaller extra b in
    if reach <? need x then
      (if mem T (id x) then None else hark_word t left rest w D L Z T (diff P (self x)) F)
    else if (reach =? need x) && mem T (id x) then
      hark_word t left rest w D L Z T P (union F (inter (hear x) (if extra <=? b then union D L else D)))
    else hark_word t left rest w D L Z T P F
  end.
Fixpoint hark (t : threat) (left : nat) (groups : list (list row)) (nodes : bits) (D L Z T P F : bits) : option (bits * bits) :=
  match groups, nodes with
  | rows :: groups', w :: nodes' =>
    if w_is0 w then hark t left groups' nodes' D L Z T P F else
    match hark_word t left rows w D L Z T P F with
    | Some (P', F') => hark t left groups' nodes' D L Z T P' F'
    | None => None
    end
  | _, _ => Some (P, F)
  end.

(* *share*: what each node of T still wants, and from whom it can come. *)
Fixpoint wants_word (rows : list row) (w : word) (T D L : bits) (wanted : nat) (open : list bits) : nat * list bits :=
  match rows with
  | [] => (wanted, open)
  | x :: rest =>
    if w_is0 (w_and w (bit x)) then wants_word rest w T D L wanted open else
    let held := count 0 (hear x) D in
    if (held <? need x) && mem T (id x) then wants_word rest w T D L (wanted + (need x - held)) (inter (hear x) L :: open)
    else wants_word rest w T D L wanted open
  end.
Fixpoint wants (groups : list (list row)) (nodes T D L : bits) (wanted : nat) (open : list bits) : nat * list bits :=
  match groups, nodes with
  | rows :: groups', w :: nodes' =>
    if w_is0 w then wants groups' nodes' T D L wanted open else
    let (wanted', open') := wants_word rows w T D L wanted open in wants groups' nodes' T D L wanted' open'
  | _, _ => (wanted, open)
  end.

(* The sum of the b greatest numbers of a list, none of which is above k: level by level. *)
Fixpoint greatest (b : nat) (l : list nat) (k total : nat) : nat :=
  match k with 0 => total | S k' => greatest b l k' (total + smaller b (tally (fun v => k <=? v) l 0)) end.
Definition votes (n : nat) (open : list bits) : list nat := map (fun v => tally (fun o => mem o v) open 0) (seq 0 n).

Definition shares (t : threat) (s : roles) : bool :=
  if local t then true else
  let Z := bad s in
  let groups := groups (asks t) in
  let a := here s in let b := there s in
  let (w1, o1) := wants groups (pT a) (pT a) (sure_of a Z) (loose_of a Z) 0 [] in
  let (wanted, open) := wants groups (pT b) (pT b) (sure_of b Z) (loose_of b Z) w1 o1 in
  if wanted =? 0 then true else
  wanted <=? greatest (left_total t Z) (votes (limit (asks t)) open) (tally (fun _ => true) open 0) 0.

(* *count*: does y, normal there, leave too few places to need x as normal here? *)
Definition size_of (t : threat) (A : bits) : nat := count 0 (full (asks t)) A.
Definition crowds_out (t : threat) (s : roles) (x y : row) : bool :=
  let Z := bad s in let a := here s in let b := there s in
  let hy := diff (hear y) (self x) in
  let hx := diff (hear x) (self y) in
  let sy := inter hy (sure_of b Z) in
  let sx := inter hx (sure_of a Z) in
  let either := union sy sx in
  let my := diff (inter hy (pQ b)) Z in
  let mx := diff (inter hx (pQ a)) Z in
  let left := left_total t Z in
  let ly := left_of t Z left y in
  let lx := left_of t Z left x in
  let two_ways := size_of t (diff (inter my mx) either) in
  let only_y := size_of t (diff (diff my mx) either) in
  let only_x := size_of t (diff (diff mx my) either) in
  let places := size_of t either in
  let more :=
    if two_faces t then
      let again := size_of t (inter (inter my mx) either) in
      size_of t (inter (inter sy sx) Z) +
      (if local t then
         let gy := smaller ly (only_y + two_ways) in
         let gx := smaller lx (only_x + two_ways) in
         gy + gx + smaller again (smaller (ly - gy) (lx - gx))
       else
         let twice := smaller left two_ways in
         twice + twice + smaller (left - twice) (again + only_y + only_x))
    else if local t then smaller ly (only_y + two_ways) + smaller lx (only_x + two_ways)
    else smaller left (only_y + only_x + two_ways) in
  places + more <? need y + need x.
