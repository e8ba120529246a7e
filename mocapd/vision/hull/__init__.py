"""The visual hull: what of the space is the person's in every camera's silhouette."""
