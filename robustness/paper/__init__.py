"""The source paper: its experiments, its figures, and its claims audited one by one."""
