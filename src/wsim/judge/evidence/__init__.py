"""What a recording says: motion, contact, joints, geometry."""
