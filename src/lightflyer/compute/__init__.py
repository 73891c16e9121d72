"""How many designs are computed: in chunks, on devices, on clusters, into a store."""
