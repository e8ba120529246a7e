"""What is judged: functions of gathered facts, which ask nothing of the machine themselves."""
