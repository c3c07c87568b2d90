(* Counting in lists: what the definition and all proofs count with. *)
From Coq Require Import List Bool Arith Lia.
Import ListNotations.

(* [cnt l f]: how many entries of [l] have [f]. *)
Definition cnt (l : list nat) (f : nat -> bool) : nat := length (filter f l).

(* [sum l f]: the sum of [f v] over the entries v of [l]. *)
Fixpoint sum (l : list nat) (f : nat -> nat) : nat :=
  match l with [] => 0 | v :: l' => f v + sum l' f end.

Lemma cnt_sum : forall l f, cnt l f = sum l (fun v => Nat.b2n (f v)).
Proof.
  unfold cnt; induction l as [|v l IH]; intros f; simpl; [reflexivity|].
  destruct (f v); simpl; rewrite IH; reflexivity.
Qed.

Lemma cnt_cons : forall v l f, cnt (v :: l) f = Nat.b2n (f v) + cnt l f.
Proof. intros. unfold cnt. simpl. destruct (f v); reflexivity. Qed.

Lemma cnt_app : forall l m f, cnt (l ++ m) f = cnt l f + cnt m f.
Proof. intros. unfold cnt. rewrite filter_app, app_length. reflexivity. Qed.

Lemma cnt_map : forall (g : nat -> nat) l f, cnt (map g l) f = cnt l (fun v => f (g v)).
Proof. intros; rewrite !cnt_sum; induction l as [|v l IH]; simpl; congruence. Qed.

Lemma sum_le : forall l f g, (forall v, In v l -> f v <= g v) -> sum l f <= sum l g.
Proof.
  induction l as [|v l IH]; simpl; intros f g H; [lia|].
  assert (f v <= g v) by auto. assert (sum l f <= sum l g) by auto. lia.
Qed.

Lemma sum_add : forall l f g, sum l (fun v => f v + g v) = sum l f + sum l g.
Proof. induction l as [|v l IH]; simpl; intros; [reflexivity|]. rewrite IH. lia. Qed.

Lemma sum_scale : forall l k f, sum l (fun v => k * f v) = k * sum l f.
Proof. induction l as [|v l IH]; simpl; intros; [lia|]. rewrite IH. lia. Qed.

Lemma sum_zero : forall l f, (forall v, In v l -> f v = 0) -> sum l f = 0.
Proof. induction l as [|v l IH]; simpl; intros f H; [reflexivity|]. rewrite IH, (H v); auto. Qed.

Lemma cnt_ext : forall l f g, (forall v, In v l -> f v = g v) -> cnt l f = cnt l g.
Proof. intros. unfold cnt. f_equal. apply filter_ext_in. assumption. Qed.

Lemma cnt_le : forall l f g, (forall v, In v l -> f v = true -> g v = true) -> cnt l f <= cnt l g.
Proof.
  intros. rewrite !cnt_sum. apply sum_le. intros v I. specialize (H v I).
  destruct (f v), (g v); simpl; try lia; discriminate (H eq_refl).
Qed.

Lemma cnt_lt : forall l f g v,
  In v l -> (forall u, In u l -> f u = true -> g u = true) -> g v = true -> f v = false -> cnt l f < cnt l g.
Proof.
  induction l as [|a l IH]; intros f g v I H G F; [contradiction|]. rewrite !cnt_cons.
  assert (M : cnt l f <= cnt l g) by (apply cnt_le; intros; apply H; simpl; auto).
  destruct I as [->|I]; [rewrite F, G; simpl; lia|].
  assert (cnt l f < cnt l g) by (apply (IH f g v); auto; intros; apply H; simpl; auto).
  pose proof (H a (or_introl eq_refl)). destruct (f a), (g a); simpl; try lia; discriminate (H1 eq_refl).
Qed.

Lemma cnt_split : forall l f g, cnt l f = cnt l (fun v => f v && g v) + cnt l (fun v => f v && negb (g v)).
Proof.
  intros. rewrite !cnt_sum, <- sum_add. induction l as [|v l IH]; simpl; [reflexivity|].
  rewrite IH. destruct (f v), (g v); simpl; lia.
Qed.

Lemma cnt_false : forall l f, (forall v, In v l -> f v = false) -> cnt l f = 0.
Proof. intros. rewrite cnt_sum. apply sum_zero. intros. rewrite H; auto. Qed.

Lemma cnt_pos : forall l f v, In v l -> f v = true -> 1 <= cnt l f.
Proof.
  intros l f v I H. assert (cnt l (fun _ => false) < cnt l f) by (apply cnt_lt with v; auto; discriminate). lia.
Qed.

Lemma cnt_le_length : forall l f, cnt l f <= length l.
Proof. unfold cnt; induction l as [|v l IH]; simpl; intros f; [lia|]. specialize (IH f). destruct (f v); simpl; lia. Qed.

Lemma cnt_true : forall l f, (forall v, In v l -> f v = true) -> cnt l f = length l.
Proof. unfold cnt; induction l as [|v l IH]; simpl; intros f H; [reflexivity|]. rewrite (H v); simpl; auto. Qed.

(* Positions beyond n that do not count may be left out. *)
Lemma cnt_seq_cut : forall n m f, n <= m -> (forall v, n <= v -> f v = false) -> cnt (seq 0 m) f = cnt (seq 0 n) f.
Proof.
  intros n m f L H. replace m with (n + (m - n)) by lia. rewrite seq_app, cnt_app, (cnt_false (seq (0 + n) (m - n))); [lia|].
  intros v I. apply in_seq in I. apply H. lia.
Qed.

(* Counting the entries of a list without repetitions is counting in any list that holds them all. *)
Lemma cnt_one : forall m a f, NoDup m -> In a m -> cnt m (fun v => (v =? a) && f v) = Nat.b2n (f a).
Proof.
  induction m as [|b m IH]; intros a f N J; [contradiction|]. rewrite cnt_cons. inversion N; subst. destruct J as [->|J].
  - rewrite Nat.eqb_refl, cnt_false; [simpl; lia|]. intros v V. destruct (Nat.eqb_spec v a); [subst; contradiction|reflexivity].
  - rewrite IH by assumption. destruct (Nat.eqb_spec b a); [subst; contradiction|reflexivity].
Qed.

Lemma cnt_incl : forall l, NoDup l -> forall m f, NoDup m -> incl l m ->
  cnt l f = cnt m (fun v => existsb (Nat.eqb v) l && f v).
Proof.
  induction l as [|a l IH]; intros N m f NM I; [rewrite (cnt_false m); reflexivity|].
  inversion N as [|? ? A N' E]; subst. rewrite cnt_cons, (IH N' m f NM) by (intros v J; apply I; simpl; auto).
  rewrite <- (cnt_one m a f NM) by (apply I; simpl; auto).
  assert (forall v, Nat.b2n ((v =? a) && f v) + Nat.b2n (existsb (Nat.eqb v) l && f v)
                    = Nat.b2n (existsb (Nat.eqb v) (a :: l) && f v)) as Q.
  { intros v. simpl. destruct (Nat.eqb_spec v a) as [->|]; simpl; [|destruct (f v), (existsb (Nat.eqb v) l); reflexivity].
    replace (existsb (Nat.eqb a) l) with false; [destruct (f a); reflexivity|].
    symmetry. apply not_true_is_false. intros X. apply existsb_exists in X. destruct X as (u & U & X).
    apply Nat.eqb_eq in X. subst. contradiction. }
  rewrite !cnt_sum, <- sum_add. clear - Q. induction m as [|v m IH]; [reflexivity|].
  cbn [sum]. rewrite Q, IH. reflexivity.
Qed.
