"""Linear equations with one dense block per body: order, factors, solutions."""
