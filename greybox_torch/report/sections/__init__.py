"""The sections of the page: one file each, with what its template of the same name prints."""
