(* Files in, an exit code out: the command line of `python -m certificates verify` around the extracted checker.
   Trusted beside it: reading files, SHA-256, the comparison with the question asked, and what is printed. *)

let fail code message = prerr_endline message; exit code

let usage problem =
  fail 2 ("usage: robustness-verified verify [--expect {robust,not-robust,apart,together}] [-r R] [-s S] [--window WINDOW]\n"
          ^ "       [-f F] [--faces {1,2}] [--bound {total,local}] graph certificate\n"
          ^ "robustness-verified verify: error: " ^ problem)

(* The file's bytes, or somewhat more than [limit] of them. *)
let read_at_most limit path =
  try
    let channel = open_in_bin path in
    let data = Buffer.create 65536 and block = Bytes.create 65536 in
    let rec go () =
      let got = input channel block 0 65536 in
      if got > 0 then (Buffer.add_subbytes data block 0 got; if Buffer.length data <= limit then go ()) in
    go ();
    close_in channel;
    Buffer.contents data
  with Sys_error problem -> fail 3 ("error: cannot read " ^ problem)

let sha256 text =
  let k = [|
    0x428a2f98; 0x71374491; 0xb5c0fbcf; 0xe9b5dba5; 0x3956c25b; 0x59f111f1; 0x923f82a4; 0xab1c5ed5;
    0xd807aa98; 0x12835b01; 0x243185be; 0x550c7dc3; 0x72be5d74; 0x80deb1fe; 0x9bdc06a7; 0xc19bf174;
    0xe49b69c1; 0xefbe4786; 0x0fc19dc6; 0x240ca1cc; 0x2de92c6f; 0x4a7484aa; 0x5cb0a9dc; 0x76f988da;
    0x983e5152; 0xa831c66d; 0xb00327c8; 0xbf597fc7; 0xc6e00bf3; 0xd5a79147; 0x06ca6351; 0x14292967;
    0x27b70a85; 0x2e1b2138; 0x4d2c6dfc; 0x53380d13; 0x650a7354; 0x766a0abb; 0x81c2c92e; 0x92722c85;
    0xa2bfe8a1; 0xa81a664b; 0xc24b8b70; 0xc76c51a3; 0xd192e819; 0xd6990624; 0xf40e3585; 0x106aa070;
    0x19a4c116; 0x1e376c08; 0x2748774c; 0x34b0bcb5; 0x391c0cb3; 0x4ed8aa4a; 0x5b9cca4f; 0x682e6ff3;
    0x748f82ee; 0x78a5636f; 0x84c87814; 0x8cc70208; 0x90befffa; 0xa4506ceb; 0xbef9a3f7; 0xc67178f2 |] in
  let state = [| 0x6a09e667; 0xbb67ae85; 0x3c6ef372; 0xa54ff53a; 0x510e527f; 0x9b05688c; 0x1f83d9ab; 0x5be0cd19 |] in
  let low x = x land 0xffffffff in
  let turn x by = low ((x lsr by) lor (x lsl (32 - by))) in
  let length = String.length text in
  let blocks = (length + 8) / 64 + 1 in
  let byte i =
    if i < length then Char.code text.[i]
    else if i = length then 0x80
    else if i >= 64 * blocks - 8 then ((8 * length) lsr (8 * (64 * blocks - 1 - i))) land 255
    else 0 in
  let w = Array.make 64 0 in
  for block = 0 to blocks - 1 do
    for t = 0 to 15 do
      let at = 64 * block + 4 * t in
      w.(t) <- (byte at lsl 24) lor (byte (at + 1) lsl 16) lor (byte (at + 2) lsl 8) lor byte (at + 3)
    done;
    for t = 16 to 63 do
      let x = w.(t - 15) and y = w.(t - 2) in
      let s0 = turn x 7 lxor turn x 18 lxor (x lsr 3) and s1 = turn y 17 lxor turn y 19 lxor (y lsr 10) in
      w.(t) <- low (w.(t - 16) + s0 + w.(t - 7) + s1)
    done;
    let v = Array.copy state in
    for t = 0 to 63 do
      let a = v.(0) and e = v.(4) in
      let s1 = turn e 6 lxor turn e 11 lxor turn e 25 and s0 = turn a 2 lxor turn a 13 lxor turn a 22 in
      let ch = (e land v.(5)) lxor (low (lnot e) land v.(6)) in
      let maj = (a land v.(1)) lxor (a land v.(2)) lxor (v.(1) land v.(2)) in
      let t1 = low (v.(7) + s1 + ch + k.(t) + w.(t)) in
      for i = 7 downto 1 do v.(i) <- v.(i - 1) done;
      v.(4) <- low (v.(4) + t1);
      v.(0) <- low (t1 + s0 + maj)
    done;
    Array.iteri (fun i x -> state.(i) <- low (x + v.(i))) state
  done;
  String.concat "" (Array.to_list (Array.map (Printf.sprintf "%08x") state))

let bytes_of text = { Checker.len = String.length text; byte_at = (fun i -> Char.code text.[i]) }

(* The machine's integers are what Extract.v takes them for. *)
let () =
  let slow word = List.length (List.filter (fun k -> (word lsr k) land 1 = 1) (List.init 62 Fun.id)) in
  let rec try_words k word =
    if k > 0 then begin
      if Checker.w_pop word <> slow word then fail 1 "internal error: words are counted wrongly";
      try_words (k - 1) (((word * 0x2545F4914F6CDD1D) lxor (word lsr 7)) land max_int)
    end in
  if Sys.int_size <> 63 then fail 1 "internal error: the checker needs a machine of 64 bits";
  try_words 100 max_int

(* What is asked, None asks nothing; and what a claim says, by the same names. *)
type question = {
  verdict : string option; r : int option; s : int option; window : int option;
  f : int option; faces : int option; bound : string option }

let asked q =
  let number name = function Some k -> [ (name, string_of_int k) ] | None -> [] in
  let word name = function Some k -> [ (name, k) ] | None -> [] in
  word "verdict" q.verdict @ number "r" q.r @ number "s" q.s @ number "window" q.window
  @ number "f" q.f @ number "faces" q.faces @ word "bound" q.bound

let parts (c : Checker.claim) =
  match c.says with
  | Checker.Robustness (yes, r, s) ->
    [ ("verdict", if yes then "robust" else "not-robust"); ("r", string_of_int r); ("s", string_of_int s) ]
  | Checker.Holding_apart (yes, f, two_faces, local) ->
    [ ("verdict", if yes then "apart" else "together"); ("f", string_of_int f);
      ("faces", if two_faces then "2" else "1"); ("bound", if local then "local" else "total") ]

(* Does the claim imply what is asked: by Lemma 1 (i) and (ii); against fewer nodes, or by more? *)
let implies (c : Checker.claim) q =
  let same name value = List.assoc_opt name (parts c) = value in
  same "verdict" q.verdict
  &&
  match c.says with
  | Checker.Holding_apart (yes, f, _, _) ->
    same "faces" (Option.map string_of_int q.faces) && same "bound" q.bound
    && (match q.f with None -> true | Some k -> if yes then k >= f else k <= f)
  | Checker.Robustness (yes, of_r, of_s) -> (
    match q.r with
    | None -> false
    | Some r ->
      let s = Option.value q.s ~default:1 in
      r >= 0 && s >= 1 && if yes then r <= of_r && s <= of_s + of_r - r else of_r <= r && of_s <= s + r - of_r)

(* Does the claim answer the question, and how? *)
let comparison c q =
  let asked = asked q and parts = parts c in
  let names list = String.concat ", " list in
  let foreign = List.filter (fun (name, _) -> not (List.mem_assoc name parts)) asked in
  let wrong = List.filter (fun (name, value) -> List.assoc_opt name parts <> Some value) asked in
  let list = names (List.map (fun (name, value) -> name ^ " " ^ value) wrong) in
  if asked = [] then (true, "compared with no question: state one to have the claim compared with it")
  else if foreign <> [] then (false, "the certificate says nothing about " ^ names (List.map fst foreign))
  else if wrong = [] then (true, "the claim is the one asked for")
  else if implies c q then (true, "the claim implies the one asked for (" ^ list ^ ")")
  else (false, "the claim proved is not the one asked for (" ^ list ^ ")")

(* A question about malicious nodes names all four of its parts. *)
let has_gap q =
  let about = q.f <> None || q.faces <> None || q.bound <> None || q.verdict = Some "apart" || q.verdict = Some "together" in
  about && (q.verdict = None || q.f = None || q.faces = None || q.bound = None)

let answer graph certificate =
  let digest = sha256 graph in
  let codes = List.map Char.code (List.of_seq (String.to_seq digest)) in
  (digest, Checker.verify codes (bytes_of graph) (bytes_of certificate))

(* For tests of many certificates: pairs of lengths on a line, then the bytes of graph and certificate; a line each. *)
let rec stream () =
  match input_line stdin with
  | exception End_of_file -> ()
  | line ->
    Scanf.sscanf line "%d %d" (fun n m ->
        let graph = really_input_string stdin n in
        let certificate = really_input_string stdin m in
        (match snd (answer graph certificate) with
         | Checker.Verified c -> Printf.printf "0 %s\n%!" (String.concat " " (List.map snd (parts c)))
         | Checker.Malformed _ -> print_string "3\n"; flush stdout
         | Checker.Rejected _ -> print_string "10\n"; flush stdout));
    stream ()

let run graph certificate question =
  let graph = read_at_most (1 lsl 28) graph in
  let certificate = read_at_most (1 lsl 30) certificate in
  let digest, outcome = answer graph certificate in
  match outcome with
  | Checker.Malformed why -> fail 3 ("malformed: " ^ why)
  | Checker.Rejected (why, place) -> fail 10 ("rejected: " ^ why ^ if place = 0 then "" else Printf.sprintf " %d" place)
  | Checker.Verified c ->
    let said =
      match c.says with
      | Checker.Robustness (yes, r, s) -> Printf.sprintf "%s (%d,%d)-robust" (if yes then "is" else "is not") r s
      | Checker.Holding_apart (yes, f, two_faces, local) ->
        Printf.sprintf "%s %s for f = %d %s" (if yes then "has a" else "has no") (if two_faces then "trap" else "violation") f
          (if local then "locally" else "in total") in
    let claim =
      Printf.sprintf "the graph with %d nodes, %d arcs and SHA-256 %s %s (evidence: %s)" c.of_nodes c.of_arcs digest said
        c.evidence in
    let answers, how = comparison c question in
    if answers then print_endline ("verified: " ^ claim ^ "; " ^ how)
    else fail 10 ("rejected: " ^ how ^ "; proved is that " ^ claim)

let () =
  let number text = match int_of_string_opt text with Some k -> Some k | None -> usage ("invalid int value: '" ^ text ^ "'") in
  let rec options files q = function
    | "--expect" :: (("robust" | "not-robust" | "apart" | "together") as v) :: rest -> options files { q with verdict = Some v } rest
    | "-r" :: k :: rest -> options files { q with r = number k } rest
    | "-s" :: k :: rest -> options files { q with s = number k } rest
    | "--window" :: k :: rest -> options files { q with window = number k } rest
    | "-f" :: k :: rest -> options files { q with f = number k } rest
    | "--faces" :: (("1" | "2") as k) :: rest -> options files { q with faces = number k } rest
    | "--bound" :: (("total" | "local") as v) :: rest -> options files { q with bound = Some v } rest
    | option :: _ when String.length option > 1 && option.[0] = '-' -> usage ("unrecognized or incomplete: " ^ option)
    | file :: rest -> options (file :: files) q rest
    | [] -> (
      if has_gap q then usage "a question about malicious nodes names --expect, -f, --faces and --bound";
      match files with
      | [ certificate; graph ] -> (
        try run graph certificate q with
        | Out_of_memory -> fail 3 "malformed: the files do not fit into memory"
        | Stack_overflow -> fail 1 "internal error: the stack is too small")
      | _ -> usage "a graph and a certificate are needed") in
  let nothing = { verdict = None; r = None; s = None; window = None; f = None; faces = None; bound = None } in
  match Array.to_list Sys.argv with
  | _ :: "verify" :: rest -> options [] nothing rest
  | [ _; "stream" ] -> set_binary_mode_in stdin true; stream ()
  | _ -> usage "the command is verify"
