"""A flexible body of sixteen masses on springs, held together by projected constraints [Hecht et al. 2009, section II]."""
