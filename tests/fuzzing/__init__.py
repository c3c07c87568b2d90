"""Whatever comes in, a command ends in one of the codes it promises: ``make fuzz SECONDS=600``."""
