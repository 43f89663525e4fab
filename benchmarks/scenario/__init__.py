"""The paper's scenario: five helicopter flights of equal time over terrain, hundreds of times."""
