"""The static site: `contents` says what goes where, `writing` puts it there."""
