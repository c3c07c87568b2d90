(* What the theorems rest on: nothing but Coq. *)
From Formal Require Import Certificate Unique Lemmas Tolerance Traps Examples Proposition1 Literal.
Print Assumptions verify_sound.
Print Assumptions describes_one.
Print Assumptions lemma_1_i.
Print Assumptions lemma_1_ii.
Print Assumptions weaken.
Print Assumptions lemma_1_last.
Print Assumptions lemma_1_v.
Print Assumptions lemma_1_v_complete.
Print Assumptions lemma_1_vi.
Print Assumptions lemma_1_vii.
Print Assumptions union_unreached.
Print Assumptions need_form.
Print Assumptions robust_together.
Print Assumptions no_trap_iff_robust_without.
Print Assumptions K5_without_an_edge_is_3_robust.
Print Assumptions a_1_robust_digraph_with_a_node_that_hears_nobody.
Print Assumptions a_graph_without_arcs_is_0_robust.
Print Assumptions the_last_line_has_no_converse.
Print Assumptions proposition_1_corrected.
Print Assumptions the_literal_graph_is_not_f1_f1_robust.
Print Assumptions the_literal_graph_has_an_in_degree_of_2.
Print Assumptions no_trap_and_not_2f1_robust.
