"""Results as files: csv, summary, HDF5, ParaView, and the folder that holds them all."""
