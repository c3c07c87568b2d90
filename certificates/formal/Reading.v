(* Reading: strings, numbers, JSON, and a guess at what a canonical graph says.

   Nothing here is trusted and nothing is proven about it: Canonical.v follows the bytes of a graph along the encoding
   of what was read, and what a certificate claims is what [verify] answers with. *)
From Coq Require Import List Bool Arith String.
From Formal Require Import Bytes Canonical.
Import ListNotations.
Local Open Scope list_scope.
Local Open Scope nat_scope.

Definition between (a c b : nat) : bool := (a <=? c) && (c <=? b).
Definition is_digit (c : nat) : bool := between digit_0 c digit_9.

(* Four hexadecimal digits. *)
Definition hex_value (c : nat) : option nat :=
  if is_digit c then Some (c - digit_0) else if between letter_a c letter_f then Some (c - letter_a + 10)
  else if between capital_A c capital_F then Some (c - capital_A + 10) else None.
Definition hex4 (b : bytes) (pos : nat) : option nat :=
  match hex_value (next b pos), hex_value (next b (pos + 1)), hex_value (next b (pos + 2)), hex_value (next b (pos + 3)) with
  | Some x, Some y, Some z, Some w => Some (((x * n16 + y) * n16 + z) * n16 + w)
  | _, _, _, _ => None
  end.

(* One code point of a string, after its backslash or in UTF-8; and the place after it. *)
Definition surrogates (b : bytes) (high pos : nat) : nat * nat :=
  if (high_surrogates <=? high) && (high <? low_surrogates) && (next b pos =? backslash) && (next b (pos + 1) =? letter_u) then
    match hex4 b (pos + 2) with
    | Some low => if (low_surrogates <=? low) && (low <? after_surrogates)
                  then (n65536 + (high - high_surrogates) * n1024 + (low - low_surrogates), pos + 6) else (high, pos)
    | None => (high, pos)
    end
  else (high, pos).
Definition escaped (b : bytes) (pos : nat) : option (nat * nat) :=
  let c := next b pos in
  if (c =? quote) || (c =? backslash) || (c =? slash) then Some (c, pos + 1) else if c =? letter_b then Some (8, pos + 1)
  else if c =? letter_f then Some (12, pos + 1) else if c =? letter_n then Some (10, pos + 1)
  else if c =? letter_r then Some (13, pos + 1) else if c =? letter_t then Some (9, pos + 1)
  else if c =? letter_u then match hex4 b (pos + 1) with Some k => Some (surrogates b k (pos + 5)) | None => None end
  else None.
Definition more (b : bytes) (pos low high : nat) : option nat :=
  let c := next b pos in if (low <=? c) && (c <? high) then Some (c - n128) else None.
Definition n192 := n128 + n64.      (* 0xC0, and so on: the first bytes of characters of 2, 3 and 4 *)
Definition n224 := n192 + n32.
Definition n240 := n224 + n16.
Definition utf8 (b : bytes) (pos : nat) : option (nat * nat) :=
  let c := next b pos in
  if c <? n32 then None else if c <? n128 then Some (c, pos + 1)
  else if c <? n192 + 2 then None
  else if c <? n224 then
    match more b (pos + 1) n128 n192 with Some x => Some ((c - n192) * n64 + x, pos + 2) | None => None end
  else if c <? n240 then
    match more b (pos + 1) (if c =? n224 then n128 + n32 else n128) (if c =? n240 - 3 then n128 + n32 else n192),
          more b (pos + 2) n128 n192 with
    | Some x, Some y => Some (((c - n224) * n64 + x) * n64 + y, pos + 3) | _, _ => None end
  else if c <? n240 + 5 then
    match more b (pos + 1) (if c =? n240 then n128 + n16 else n128) (if c =? n240 + 4 then n128 + n16 else n192),
          more b (pos + 2) n128 n192, more b (pos + 3) n128 n192 with
    | Some x, Some y, Some z => Some ((((c - n240) * n64 + x) * n64 + y) * n64 + z, pos + 4) | _, _, _ => None end
  else None.

(* The rest of a string, after its opening quote. *)
Fixpoint string_from (fuel : nat) (b : bytes) (pos : nat) (codes : list nat) : option (list nat * nat) :=
  match fuel with
  | 0 => None
  | S f =>
    let c := next b pos in
    if c =? quote then Some (rev_append codes [], pos + 1) else
    match (if c =? backslash then escaped b (pos + 1) else utf8 b pos) with
    | Some (k, pos') => string_from f b pos' (k :: codes)
    | None => None
    end
  end.

Fixpoint digits_from (fuel : nat) (b : bytes) (pos : nat) (ds : list nat) : list nat * nat :=
  match fuel with
  | 0 => (rev_append ds [], pos)
  | S f => let c := next b pos in if is_digit c then digits_from f b (pos + 1) (c :: ds) else (rev_append ds [], pos)
  end.
Definition value_of (ds : list nat) : nat := fold_left (fun k c => k * 10 + (c - digit_0)) ds 0.

(* The canonical graph. *)
Definition id_at (b : bytes) (pos : nat) : option (nat * nat) :=
  let (ds, pos') := digits_from 11 b pos [] in
  if between 1 (List.length ds) 10 then Some (value_of ds, pos') else None.

Fixpoint arcs_from (fuel : nat) (b : bytes) (pos : nat) (found : list (nat * nat)) : option (list (nat * nat) * nat) :=
  match fuel with
  | 0 => None
  | S f =>
    let pos := if next b pos =? comma then pos + 1 else pos in
    if next b pos =? list_opens then
      match id_at b (pos + 1) with
      | Some (u, p) => match id_at b (p + 1) with
                       | Some (v, p') => arcs_from f b (p' + 1) ((u, v) :: found)
                       | None => None end
      | None => None
      end
    else Some (rev_append found [], pos)
  end.

Fixpoint labels_from (depth fuel : nat) (b : bytes) (pos : nat) : option (list label * nat) :=
  match depth with
  | 0 => None
  | S d =>
    (fix go (k pos : nat) (found : list label) {struct k} : option (list label * nat) :=
      match k with
      | 0 => None
      | S k' =>
        let pos := if next b pos =? comma then pos + 1 else pos in
        let c := next b pos in
        if c =? list_closes then Some (rev_append found [], pos)
        else if c =? quote then
          match string_from fuel b (pos + 1) [] with Some (s, p) => go k' p (LStr s :: found) | None => None end
        else if c =? list_opens then
          match labels_from d fuel b (pos + 1) with Some (l, p) => go k' (p + 1) (LTup l :: found) | None => None end
        else
          let negative := c =? minus in
          let (ds, p) := digits_from 21 b (if negative then pos + 1 else pos) [] in
          match ds with [] => None | _ => go k' p (LInt negative ds :: found) end
      end) fuel pos []
  end.

Definition read_graph (b : bytes) : option (list (nat * nat) * list label) :=
  let fuel := len b + 1 in
  match follow b 0 opening with
  | None => None
  | Some p1 =>
    match arcs_from fuel b p1 [] with
    | None => None
    | Some (arcs, p2) =>
      match follow b p2 middle with
      | None => None
      | Some p3 => match labels_from 9 fuel b p3 with Some (labels, _) => Some (arcs, labels) | None => None end
      end
    end
  end.

(* JSON. A number with a fraction or an exponent is JReal, of which nobody asks more. *)
Inductive json :=
| JNull | JBool (b : bool) | JReal | JInt (negative : bool) (digits : list nat) | JStr (codes : list nat)
| JArr (items : list json) | JObj (members : list (list nat * json)).

Fixpoint blanks (fuel : nat) (b : bytes) (pos : nat) : nat :=
  match fuel with
  | 0 => pos
  | S f => let c := next b pos in
    if (c =? blank) || (c =? 9) || (c =? 10) || (c =? 13) then blanks f b (pos + 1) else pos
  end.

Definition number_at (fuel : nat) (b : bytes) (pos : nat) : option (json * nat) :=
  let negative := next b pos =? minus in
  let pos := if negative then pos + 1 else pos in
  let (ds, p) := if next b pos =? digit_0 then ([digit_0], pos + 1) else digits_from fuel b pos [] in
  match ds with
  | [] => None
  | _ =>
    let q := if (next b p =? point) && is_digit (next b (p + 1)) then snd (digits_from fuel b (p + 1) []) else p in
    let sign := if (next b (q + 1) =? plus) || (next b (q + 1) =? minus) then q + 2 else q + 1 in
    let e := ((next b q =? capital_E) || (next b q =? letter_e)) && is_digit (next b sign) in
    let q' := if e then snd (digits_from fuel b sign []) else q in
    if q' =? p then
      if List.length ds + (if negative then 1 else 0) <=? 20 then Some (JInt negative ds, p) else None
    else Some (JReal, q')
  end.

Definition same_codes (a b : list nat) : bool := match compare_lists a b with Eq => true | _ => false end.
Definition lookup (key : list nat) (members : list (list nat * json)) : option json :=
  match List.find (fun m => same_codes (fst m) key) members with Some (_, v) => Some v | None => None end.

Fixpoint value_at (depth fuel : nat) (b : bytes) (pos : nat) {struct depth} : option (json * nat) :=
  match depth with
  | 0 => None
  | S d =>
    let items := fix items (k pos : nat) (found : list json) {struct k} : option (json * nat) :=
      match k with
      | 0 => None
      | S k' =>
        match value_at d fuel b (blanks fuel b pos) with
        | Some (v, p) =>
          let p := blanks fuel b p in
          if next b p =? comma then items k' (p + 1) (v :: found)
          else if next b p =? list_closes then Some (JArr (rev_append (v :: found) []), p + 1) else None
        | None => None
        end
      end in
    let members := fix members (k pos : nat) (found : list (list nat * json)) {struct k} : option (json * nat) :=
      match k with
      | 0 => None
      | S k' =>
        let pos := blanks fuel b pos in
        if next b pos =? quote then
          match string_from fuel b (pos + 1) [] with
          | Some (key, p) =>
            let p := blanks fuel b p in
            match next b p =? colon, lookup key found with
            | true, None =>
              match value_at d fuel b (blanks fuel b (p + 1)) with
              | Some (v, p) =>
                let p := blanks fuel b p in
                if next b p =? comma then members k' (p + 1) ((key, v) :: found)
                else if next b p =? object_closes then Some (JObj ((key, v) :: found), p + 1) else None
              | None => None end
            | _, _ => None end
          | None => None end
        else None
      end in
    let c := next b pos in
    if c =? quote then match string_from fuel b (pos + 1) [] with Some (s, p) => Some (JStr s, p) | None => None end
    else if c =? list_opens then
      let p := blanks fuel b (pos + 1) in if next b p =? list_closes then Some (JArr [], p + 1) else items fuel p []
    else if c =? object_opens then
      let p := blanks fuel b (pos + 1) in if next b p =? object_closes then Some (JObj [], p + 1) else members fuel p []
    else if c =? letter_n then match follow b pos (text "null") with Some p => Some (JNull, p) | None => None end
    else if c =? letter_t then match follow b pos (text "true") with Some p => Some (JBool true, p) | None => None end
    else if c =? letter_f then match follow b pos (text "false") with Some p => Some (JBool false, p) | None => None end
    else number_at fuel b pos
  end.

Definition read_json (b : bytes) : option json :=
  let fuel := len b + 1 in
  match value_at n16 fuel b (blanks fuel b 0) with
  | Some (v, p) => if blanks fuel b p =? len b then Some v else None
  | None => None
  end.

(* An object with exactly these keys; a number; a list of them. *)
Definition object_with (keys : list string) (v : json) : option (list (list nat * json)) :=
  match v with
  | JObj members => if (List.length members =? List.length keys)
                       && forallb (fun k => match lookup (text k) members with Some _ => true | None => false end) keys
                    then Some members else None
  | _ => None
  end.
Definition field (key : string) (members : list (list nat * json)) : json :=
  match lookup (text key) members with Some v => v | None => JNull end.
Definition is_text (s : string) (v : json) : bool := match v with JStr codes => same_codes codes (text s) | _ => false end.
Definition natural (v : json) : option nat :=
  match v with
  | JInt negative ds => if List.length ds <=? 10 then
                          let k := value_of ds in if negative && (0 <? k) then None else Some k
                        else None
  | _ => None
  end.
Fixpoint naturals (l : list json) (found : list nat) : option (list nat) :=
  match l with
  | [] => Some (rev_append found [])
  | v :: l' => match natural v with Some k => naturals l' (k :: found) | None => None end
  end.
Definition ids (n : nat) (v : json) : option (list nat) :=
  match v with
  | JArr l => match naturals l [] with
              | Some found => if forallb (fun i => i <? n) found then Some found else None
              | None => None end
  | _ => None
  end.
