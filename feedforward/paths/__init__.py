"""Reference paths as functions of time that know their derivatives and their smoothness."""
