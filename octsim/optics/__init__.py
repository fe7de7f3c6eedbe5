"""What light meets and how it is changed there: scene, formulas, beam, detector."""
