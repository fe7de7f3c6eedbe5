"""What each effect that the thesis left out changes in a scene, and what it costs."""
