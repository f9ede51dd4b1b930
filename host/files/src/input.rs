//! Files that are read: regular ones up to a stated size.
