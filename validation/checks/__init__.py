"""One function a kind of claim: takes a case, measures our side against the reference."""
