//! Motion-capture files in and out: text only, no mathematics.
