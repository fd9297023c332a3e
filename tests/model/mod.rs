mod extended_lagrange;
