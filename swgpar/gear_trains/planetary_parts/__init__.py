"""What planetary trains share: parts with their keys, equations of motion, natural modes."""
