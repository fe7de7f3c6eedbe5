"""What a run consists of, and how it is labelled, streamed, read and written."""
