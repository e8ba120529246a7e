"""The paper's own tracker, kept selectable so that both can be measured, and its offline tools."""
