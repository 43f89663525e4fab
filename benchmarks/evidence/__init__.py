"""Which norm predicts collisions: many sets of five flights, judged by closed-loop simulation."""
