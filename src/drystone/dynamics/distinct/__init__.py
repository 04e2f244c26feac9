"""The distinct element method of Cundall for rigid blocks: see `dynamics.distinct.engine`."""
