"""The world: sonar, scene, echoes."""
